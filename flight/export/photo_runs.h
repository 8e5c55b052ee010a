/// Photos that a mission file takes in flight, without stops.
///
/// Autopilots that follow mission files trigger a camera at equal distances along a leg. The photos
/// are at their planned positions only if they are evenly spaced on one straight line and share one
/// direction. The vehicle stops at the first and the last photo of such a run, so that its start
/// and end are exact. Between them it flies one straight leg. All other photos are taken at stops.
/// A trigger at equal time intervals is not used, because the acceleration of the vehicle would
/// shift the photos.
#pragma once

#include "flight/export/flight_plan.h"

namespace skycap::flight {

/// Maximum distance between the planned and the actual position of a photo in a run, as a fraction
/// of the spacing of the photos.
inline constexpr double run_evenness = 0.1;

/// Returns the plan with runs of photos that are taken in flight, where this is possible and
/// faster. The capture points of these photos are moved from `waypoints` to `passed`, in their
/// order. Returns the plan unchanged if it has no `photo` or if its legs are curves.
FlightPlan with_photo_runs(FlightPlan plan);

/// Returns the number of photos in all runs of the plan.
std::size_t photos_in_runs(const FlightPlan& plan);

}  // namespace skycap::flight
