/// A survey's ways in time, and the frames of a sensor that also measures on them.
///
/// A camera turns evenly from one view to the next, in yaw and in pitch, so that it never leaves
/// the gimbal's limits; it turns between frames and stands while it is exposed. A scanner is fixed
/// to the vehicle, which turns as in the files of its mission: evenly on the way's last straight
/// piece.
#pragma once

#include <vector>

#include "flight/flight_options.h"
#include "flight/motion/motion.h"
#include "flight/motion/picture_bounds.h"
#include "flight/route/route.h"
#include "geometry/place/pose.h"
#include "missions/session/survey_flight.h"
#include "missions/session/view_in_flight.h"

namespace skycap::missions::session {

class WayMotion {
 public:
  /// Of the vehicle, in its weather.
  explicit WayMotion(const flight::FlightOptions& options);

  /// From leaving a view until the camera looks along `to` at the way's end, with a stop in each
  /// corner [s].
  double time(const FlownLeg& way, const geometry::View& from, const geometry::View& to) const;

  /// Views of the frames on the way, one every `period` [s] from the start, none within half of one
  /// of the end; their times are from the start. Empty for a way of no length.
  std::vector<ViewInFlight> frames(const FlownLeg& way, const geometry::View& from,
                                   const geometry::View& to, double period) const;

  double rest() const { return rest_; }  ///< at a view [s]

  /// How long a survey takes from the pad until it leaves each of its views [s]: take-off, ways,
  /// and rests at views. The way home is not part of it. `legs` as in FlownSurvey.
  std::vector<double> survey_times(const std::vector<FlownLeg>& legs,
                                   const std::vector<geometry::View>& views) const;

 private:
  flight::Motion motion_;
  double climb_;     ///< from the pad to where the first way begins [m]
  double rest_;      ///< at a view [s]
  bool turns_last_;  ///< on the last piece of a way
};

/// Views of all that is measured on a route: its pictures, at stations or in passing, or the scans
/// that a scanner takes from leaving the place above the pad until it is back there.
std::vector<ViewInFlight> measured_views(const flight::FlightOptions& options,
                                         const flight::Route& route);

/// How sharp frames are that a camera takes at the cruise speed.
flight::PictureBounds moving_bounds_of(const flight::FlightOptions& options);

}  // namespace skycap::missions::session
