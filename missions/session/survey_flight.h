/// The vehicle while a survey runs: it goes only where space was proven free with what was known at
/// that moment.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "flight/flight_options.h"
#include "flight/route/pad_ground.h"
#include "flight/space/measured_space.h"
#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "missions/session/view_in_flight.h"

namespace skycap::missions::session {

/// A leg as it was flown to a view.
struct FlownLeg {
  std::vector<Eigen::Vector3d> points;
  double clearance = 0.0;  ///< proven, with what was known when it was flown [m], see LegProof
};

/// What a flown survey leaves behind.
struct FlownSurvey {
  std::shared_ptr<const flight::MeasuredSpace> measured;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::vector<FlownLeg> legs;  ///< legs[i] leads to view i, the first one from above the pad
  std::size_t refused = 0;     ///< proposed views that could not be reached
  std::vector<flight::PadGround> grounds{};  ///< of pad and rally points, where it was measured

  /// From the pad until each view is left [s], see WayMotion::survey_times().
  std::vector<double> times{};

  double time() const { return times.empty() ? 0.0 : times.back(); }  ///< of all views [s]
  double length() const;
  double min_clearance() const;  ///< of all legs
};

class SurveyFlight {
 public:
  /// Throws Error{bad_config} if the first view cannot be reached from the pad through space that
  /// the pilot vouches for, or the ground of pad or rally points is known to be unfit.
  SurveyFlight(const flight::FlightOptions& options, const geometry::View& first_view,
               unsigned threads);
  ~SurveyFlight();

  /// Whether views may be there by what is known at present: among neighbours only where it is
  /// free, and a scanner's only where there is a certified way home. Cheaper than can_reach(),
  /// which asks more; safe to call in parallel. Throws survey::Interrupted after a stop.
  bool may_be_at(const Eigen::Vector3d& place) const;

  /// Whether the vehicle can look that way and get there along legs that are proven free, by a
  /// scanner with a certified way home from all of their points. Throws survey::Interrupted after a
  /// stop.
  bool can_reach(const Eigen::Vector3d& from, const geometry::View& to);

  /// Lets a stop end can_reach() wherever it is.
  void stop_on(std::stop_token stop);

  /// The way that the last can_reach() found.
  const FlownLeg& way() const;

  /// Views of the frames that a camera which measures on the way takes there, their times counted
  /// from leaving the first view.
  std::vector<ViewInFlight> frames(const geometry::View& from, const geometry::View& to) const;

  /// How long that way takes, until the vehicle leaves the second view [s].
  double time(const geometry::View& from, const geometry::View& to) const;

  /// A way from one place to another that is proven free with what is known at present; nothing if
  /// none is found. What can_reach() found stands.
  std::optional<FlownLeg> find_way(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  const Eigen::Vector3d& pad() const;
  const Eigen::Vector3d& above_pad() const;  ///< where the take-off's climb ends

  /// Calls of can_reach() that said no.
  std::size_t refused() const;

  /// Takes over what an earlier run of the same survey found: the way, and how many calls said no.
  void take_way(FlownLeg way, std::size_t refused);

  /// Flies that way.
  void fly();

  /// Learns from a scan what is free.
  void take_in(const geometry::Scan& scan);

  /// The survey with these views; further calls on this object are not allowed.
  FlownSurvey finish(const std::vector<geometry::View>& views);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::missions::session
