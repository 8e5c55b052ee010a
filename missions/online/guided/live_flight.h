/// A live survey flown: to a view along its proven way, a scan there, the next view; and home.
///
/// Whatever goes wrong, the vehicle holds where it is on the leg, and then, if that is asked for
/// and it is known where it is, flies home: back along the leg, along a way to the pad that was
/// proven before the leg was begun, and down. Nothing else is flown. The survey stays as it is in
/// its folder, and goes on when it is flown again.
#pragma once

#include <cstddef>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/motion.h"
#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "missions/online/guided/guided_flight.h"
#include "missions/online/guided/trouble.h"
#include "missions/online/live/live_survey.h"

namespace skycap::missions::online {

/// Takes scan `number` of the view that is wanted; the camera takes itself to be at `taken`. Throws
/// Error if there is none.
using Sensor = std::function<geometry::Scan(const geometry::View& wanted,
                                            const geometry::View& taken, std::size_t number)>;

struct FlightOptions {
  bool returns_on_failure = false;  ///< else the vehicle holds until somebody takes control
  double sensing_limit = 60.0;      ///< that a scan may take [s]
  double planning_limit = 60.0;     ///< that the next way may take [s]
  double vouched = 2.5;             ///< of the climb, the first metres that the pilot answers for
  std::function<void(const std::string&)> note = [](const std::string&) {};  ///< what happens
  std::function<void()> show = [] {};  ///< called after each scan, beside the flight
  /// Has work done beside the flight.
  std::function<std::future<void>(std::function<void()>)> launch = [](std::function<void()> work) {
    return std::async(std::launch::async, std::move(work));
  };
};

struct FlightEnd {
  MaybeTrouble trouble;     ///< why it ended before the survey was over
  bool has_landed = false;  ///< on the pad, from here
};

class LiveFlight {
 public:
  /// Keeps references. The survey must be one with a vehicle.
  LiveFlight(LiveSurvey& survey, GuidedFlight& vehicle, const flight::Motion& motion, Sensor sensor,
             FlightOptions options);

  /// Flies from a vehicle that is prepared (preflight.h) to the end of the survey, or of the
  /// flight.
  FlightEnd run();

 private:
  MaybeTrouble begin();
  MaybeTrouble go_on();
  MaybeTrouble visit(const geometry::View& view);
  void search_way(const geometry::View& view);
  MaybeTrouble find_way(const geometry::View& view);
  MaybeTrouble check_battery();
  MaybeTrouble sense(const geometry::View& view);
  MaybeTrouble plan();
  MaybeTrouble beside(std::function<void()> work, double limit, TroubleKind kind,
                      const std::string& what);
  FlightEnd end(const Trouble& trouble);
  FlightEnd hold(const Trouble& trouble);
  FlightEnd go_home(const MaybeTrouble& trouble);
  double share_for(const std::vector<Eigen::Vector3d>& way) const;
  std::vector<Eigen::Vector3d> way_home() const;

  LiveSurvey& survey_;
  GuidedFlight& vehicle_;
  flight::Motion motion_;
  Eigen::Vector3d pad_, above_pad_;
  Sensor sensor_;
  FlightOptions options_;
  Eigen::Vector3d here_ = Eigen::Vector3d::Zero();  ///< where the last way ended
  std::vector<Eigen::Vector3d> home_;  ///< proven, from where the last way began to above the pad

  bool has_climbed_ = false;      ///< else it lands where it is
  bool is_gimbal_noted_ = false;  ///< that its reports are against the vehicle

  // What goes on beside the flight leaves its results here, and may do so after the flight.
  std::vector<Eigen::Vector3d> way_;  ///< to the next view
  geometry::Scan scan_;
  std::optional<session::FlownLeg> home_found_;
  bool is_new_ = false;  ///< the scan
  std::future<void> work_;
};

}  // namespace skycap::missions::online
