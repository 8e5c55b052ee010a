/// Flight of a live survey: repeats verified path, scan and planning until the survey ends, then
/// returns to the pad.
///
/// After any failure the vehicle holds position on its leg. If requested, and if its position is
/// known, it then returns: back along the leg, along a path to the pad that was verified before the
/// leg was started, and down. No other paths are flown. The survey is kept in its folder and
/// continues with the next flight.
#pragma once

#include <cstddef>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/motion.h"
#include "geometry/points/scan.h"
#include "geometry/pose/pose.h"
#include "missions/online/guided/flight_failure.h"
#include "missions/online/guided/guided_flight.h"
#include "missions/online/live/live_survey.h"

namespace skycap::missions::online {

/// Takes scan `number` for the view `requested`. `actual_view` is the estimated camera pose. Throws
/// Error if no scan is available.
using Sensor = std::function<geometry::Scan(const geometry::View& requested,
                                            const geometry::View& actual_view, std::size_t number)>;

struct FlightOptions {
  /// Return after a failure instead of holding until a pilot takes control.
  bool returns_on_failure = false;
  double sensing_limit = 60.0;   ///< Maximum duration of a scan [s].
  double planning_limit = 60.0;  ///< Maximum duration of planning the next path [s].
  /// Height of the first part of the climb, which is assumed free (the pilot must check) [m].
  double checked_height = 2.5;
  /// Receives progress messages.
  std::function<void(const std::string&)> note = [](const std::string&) {};
  std::function<void()> show = [] {};  ///< Called after each scan, in the background.
  /// Requests to hold, and the receiver of the vehicle's position. The flight sets its note.
  FlightObserver observer;
  /// Runs work in the background of the flight.
  std::function<std::future<void>(std::function<void()>)> launch = [](std::function<void()> work) {
    return std::async(std::launch::async, std::move(work));
  };
};

/// Runs work before it returns, for autopilots whose time does not advance meanwhile.
std::future<void> run_at_once(const std::function<void()>& work);

struct FlightEnd {
  MaybeFailure failure;     ///< Reason for an early end of the survey.
  bool has_landed = false;  ///< True after a landing on the pad under this program's control.
};

class LiveFlight {
 public:
  /// Keeps references to `survey` and `vehicle`. The survey must have a vehicle.
  LiveFlight(LiveSurvey& survey, GuidedFlight& vehicle, const flight::Motion& motion, Sensor sensor,
             FlightOptions options);

  /// Flies from a prepared vehicle (preflight.h) to the end of the survey or of the flight.
  FlightEnd run();

 private:
  MaybeFailure begin();
  MaybeFailure go_on();
  MaybeFailure visit(const geometry::View& view);
  void search_path(const geometry::View& view);
  MaybeFailure find_path(const geometry::View& view);
  MaybeFailure check_battery();
  MaybeFailure sense(const geometry::View& view);
  MaybeFailure plan();
  MaybeFailure run_async(std::function<void()> work, double limit, FailureKind kind,
                         const std::string& what);
  FlightEnd end(const FlightFailure& failure);
  FlightEnd hold(const FlightFailure& failure);
  FlightEnd return_to_home(const MaybeFailure& failure);
  double share_for(const std::vector<Eigen::Vector3d>& path) const;
  std::vector<Eigen::Vector3d> return_path() const;

  LiveSurvey& survey_;
  GuidedFlight& vehicle_;
  flight::Motion motion_;
  Eigen::Vector3d pad_, above_pad_;
  Sensor sensor_;
  FlightOptions options_;
  Eigen::Vector3d here_ = Eigen::Vector3d::Zero();  ///< End of the last path.
  /// Verified path from the start of the last path to the position above the pad.
  std::vector<Eigen::Vector3d> home_;

  /// The climb has been completed; otherwise the vehicle lands at its current position.
  bool has_climbed_ = false;
  /// The user has been notified of airframe-relative gimbal reports.
  bool is_gimbal_noted_ = false;

  // Results of background work, which may be written after the end of the flight.
  std::vector<Eigen::Vector3d> path_;  ///< Path to the next view.
  geometry::Scan scan_;
  std::optional<session::ExecutedLeg> found_return_path_;
  bool is_new_ = false;  ///< False if the survey already contained the last scan.
  std::future<void> work_;
};

}  // namespace skycap::missions::online
