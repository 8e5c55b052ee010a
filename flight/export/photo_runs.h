/// Photos that a mission file has taken without a stop.
///
/// Autopilots that follow mission files trigger a camera at even distances along a leg. This is the
/// planned position of every photo only if the photos are on one straight line, evenly spaced, and
/// taken with one aim. The vehicle stops at the first and the last photo of such a run, so that its
/// start and end are exact; between them it flies one straight leg. All other photos are taken at
/// stops. A trigger at even times is not used: the vehicle accelerates, so it would shift photos.
#pragma once

#include "flight/export/flight_plan.h"

namespace skycap::flight {

/// Greatest distance between the planned and the actual position of a photo in a run, as a fraction
/// of the distance between its photos.
inline constexpr double run_evenness = 0.1;

/// The plan with the photos between its stops taken without a stop, where that is possible and
/// faster. Such stations are moved from `waypoints` to `passed`, in their order. Unchanged without
/// `plan.photo`, and where legs are curves.
FlightPlan with_photo_runs(FlightPlan plan);

/// The number of photos that the plan takes without a stop, by its runs.
std::size_t photos_in_runs(const FlightPlan& plan);

}  // namespace skycap::flight
