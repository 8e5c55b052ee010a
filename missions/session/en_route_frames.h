/// Timing of a survey's paths, and the frames of sensors that measure en route.
///
/// A camera rotates between views at constant rates of yaw and pitch, so that it stays within the
/// gimbal's limits. It rotates between frames and is at rest during exposure. A scanner is fixed to
/// the vehicle, which rotates as in the mission's files: at constant rate on the last straight
/// segment of a path.
#pragma once

#include <vector>

#include "flight/flight_options.h"
#include "flight/motion/image_motion_bounds.h"
#include "flight/motion/motion.h"
#include "flight/route/route.h"
#include "geometry/pose/pose.h"
#include "missions/session/survey_flight.h"
#include "missions/session/view_in_flight.h"

namespace skycap::missions::session {

class LegMotion {
 public:
  /// Uses the vehicle and the weather of `options`.
  explicit LegMotion(const flight::FlightOptions& options);

  /// Returns the time from the departure from `from` until the camera is aimed at `to` at the end
  /// of the path, with a stop at each corner [s].
  double time(const ExecutedLeg& flown_leg, const geometry::View& from,
              const geometry::View& to) const;

  /// Returns the en-route views at intervals of `period` [s] from the start of the path, except
  /// within half a period of its end. Times are relative to the start. Returns an empty list for a
  /// path of zero length.
  std::vector<ViewInFlight> frames(const ExecutedLeg& flown_leg, const geometry::View& from,
                                   const geometry::View& to, double period) const;

  double rest() const { return rest_; }  ///< Returns the time at rest at a view [s].

  /// Returns the times from take-off until the departure from each view [s]: take-off, paths and
  /// rests at views, without the return. `legs` is as in FlightRecord.
  std::vector<double> survey_times(const std::vector<ExecutedLeg>& legs,
                                   const std::vector<geometry::View>& views) const;

 private:
  flight::Motion motion_;
  double climb_;     ///< Height of the climb from the pad to the start of the first path [m].
  double rest_;      ///< Time at rest at a view [s].
  bool turns_last_;  ///< Rotation occurs only on the last segment of a path.
};

/// Returns the views of all measurements on a route: photos at stations or during a fly-through, or
/// a scanner's scans between departure from and return to the position above the pad.
std::vector<ViewInFlight> measured_views(const flight::FlightOptions& options,
                                         const flight::Route& route);

/// Returns the limits on motion blur and skew of images taken at cruise speed.
flight::ImageMotionBounds compute_motion_bounds(const flight::FlightOptions& options);

}  // namespace skycap::missions::session
