/// Vehicle during a survey. It flies only through space that is verified as free with the current
/// knowledge.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/measured_space.h"
#include "flight/flight_options.h"
#include "flight/route/landing_surface.h"
#include "geometry/points/scan.h"
#include "geometry/pose/pose.h"
#include "missions/session/view_in_flight.h"

namespace skycap::missions::session {

/// Flown leg to a view.
struct ExecutedLeg {
  std::vector<Eigen::Vector3d> points;
  /// Clearance verified with the knowledge at the time of the flight [m], see LegVerification.
  double clearance = 0.0;
};

/// Result of a flown survey.
struct FlightRecord {
  std::shared_ptr<const flight::MeasuredSpace> measured;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::vector<ExecutedLeg> legs;  ///< legs[i] leads to view i; the first leg starts above the pad.
  std::size_t rejected = 0;       ///< Number of proposed views that were unreachable.
  std::vector<flight::LandingSurface>
      landing_surfaces{};  ///< Measured ground of the pad and rally points.

  /// Times from take-off until the departure from each view [s], see LegMotion::survey_times().
  std::vector<double> times{};

  /// Returns the duration of the whole survey [s].
  double time() const { return times.empty() ? 0.0 : times.back(); }
  double length() const;
  double min_clearance() const;  ///< Returns the minimum clearance of all legs [m].
};

class SurveyFlight {
 public:
  /// Throws Error{bad_config} if the first view cannot be reached from the pad through space that
  /// is assumed free (the pilot must check). Throws Error{bad_config} also if the known ground of
  /// the pad or of rally points is unsuitable.
  SurveyFlight(const flight::FlightOptions& options, const geometry::View& first_view,
               unsigned threads);
  ~SurveyFlight();

  /// Returns whether views at this position are currently admissible. Next to neighbouring
  /// buildings, the position must be free. For scanners, a verified return must exist. Faster and
  /// less strict than can_reach(). Thread-safe. Throws survey::Interrupted after a stop request.
  bool may_be_at(const Eigen::Vector3d& position) const;

  /// Returns whether the vehicle can aim in this direction and reach the view along verified
  /// collision-free legs. For scanners, a verified return must exist from all their points. Throws
  /// survey::Interrupted after a stop request.
  bool can_reach(const Eigen::Vector3d& from, const geometry::View& to);

  /// Sets the stop token that interrupts can_reach().
  void stop_on(std::stop_token stop);

  /// Returns the path found by the last successful call of can_reach().
  const ExecutedLeg& path() const;

  /// Returns the views of the en-route frames on the path path(). Times are relative to the
  /// departure from the first view [s].
  std::vector<ViewInFlight> frames(const geometry::View& from, const geometry::View& to) const;

  /// Returns the duration of the path path(), from the departure from the first view until that
  /// from the second [s].
  double time(const geometry::View& from, const geometry::View& to) const;

  /// Returns a path that is verified collision-free with the current knowledge, or an empty value
  /// if none is found. Does not change path().
  std::optional<ExecutedLeg> find_path(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  const Eigen::Vector3d& pad() const;
  const Eigen::Vector3d& above_pad() const;  ///< Returns the end of the take-off climb.

  /// Returns the number of unsuccessful calls of can_reach().
  std::size_t rejected() const;

  /// Restores the path and the number of unsuccessful calls from an earlier run of the same survey.
  void add_leg(ExecutedLeg path, std::size_t rejected);

  /// Flies the path returned by path().
  void fly();

  /// Updates the free space and the pads from a scan.
  void add_scan(const geometry::Scan& scan);

  /// Returns the result of a survey with these views. No other member function may be called
  /// afterwards.
  FlightRecord finish(const std::vector<geometry::View>& views);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::missions::session
