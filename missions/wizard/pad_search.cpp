#include "missions/wizard/pad_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "flight/clearance/segment_distance.h"
#include "flight/route/pad_check.h"
#include "flight/rtl/rtl_profile.h"
#include "geometry/error.h"

namespace skycap::missions::wizard {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

flight::Obstacles without_fence(flight::Obstacles rules) {
  rules.fence.reset();
  return rules;
}

}  // namespace

PadSearch::PadSearch(flight::FlightOptions flight, std::vector<AlignedBox3d> unknown,
                     PadFence fence)
    : flight_(std::move(flight)),
      unknown_(std::move(unknown)),
      space_(fence == PadFence::keep ? flight_.rules() : without_fence(flight_.rules())),
      pad_space_(without_ground(without_fence(flight_.rules()))) {}

std::optional<Vector3d> PadSearch::find_pad_beside(const AlignedBox3d& unknown, double top,
                                                   std::optional<double> view_reach) const {
  constexpr double farthest = 100.0, farthest_of_dji = 200.0;
  const bool is_dji = flight_.required_vehicle().autopilot == flight::AutopilotType::dji;
  if (is_dji && view_reach) {
    constexpr double rounding = 1.0;
    const double first =
        *view_reach + rounding + flight::dji_climb_distance(flight_.braking_before_return());
    if (const auto pad = between(unknown, top, first, farthest_of_dji)) return pad;
  }
  const double margin = 2.0 * flight_.clearance + 1.0;
  return between(unknown, top, margin + (is_dji ? flight::dji_lands_at_once : 0.0), farthest);
}

/// Whose distance from the unknown box is in that interval.
std::optional<Vector3d> PadSearch::between(const AlignedBox3d& unknown, double top, double first,
                                           double farthest) const {
  constexpr int directions = 16;
  constexpr double step = 5.0;
  const double required_room = 3.0 * flight_.clearance;
  const Vector2d middle = unknown.center().head<2>();
  const Vector2d corner = 0.5 * std::numbers::sqrt2 * unknown.sizes().head<2>();
  for (int steps = 0; first + steps * step <= farthest; ++steps) {
    const double find_pad_beside = first + steps * step;
    Vector3d best = Vector3d::Zero();
    double max_room = required_room;
    for (int i = 0; i < directions; ++i) {
      const double azimuth = 2.0 * std::numbers::pi * i / directions;
      const Vector2d direction(-std::sin(azimuth), -std::cos(azimuth));  // starts in the south
      const Vector2d position =
          middle + direction.cwiseProduct(corner) + find_pad_beside * direction;
      const auto pad = at({std::round(position.x()), std::round(position.y())});
      if (!pad) continue;
      const double free_distance = climb_clearance(*pad, top, 2.0 * required_room);
      if (free_distance <= max_room) continue;
      best = *pad;
      max_room = free_distance;
    }
    if (max_room > required_room) return best;
  }
  return std::nullopt;
}

std::optional<Vector3d> PadSearch::at(const Vector2d& position) const {
  const flight::AirspaceOptions& airspace = flight_.airspace;
  const std::optional<double> ground =
      airspace.terrain ? airspace.terrain(position) : airspace.base.z();
  if (!ground) return std::nullopt;
  return Vector3d(position.x(), position.y(), std::round(100.0 * *ground) / 100.0);
}

double PadSearch::climb_clearance(const Vector3d& pad, double top, double up_to) const {
  flight::RouteOptions options = flight_.route(pad);
  options.landing_surfaces = flight_.landing_surfaces(pad, {});
  options.takeoff_climb = std::max(options.takeoff_climb, top - pad.z());
  const Vector3d home = pad + options.takeoff_climb * Vector3d::UnitZ();
  if (comes_near_unknown({pad, home})) return 0.0;
  try {
    check_pad(space_, &pad_space_, options);
  } catch (const Error&) {
    return 0.0;
  }
  return pad_space_.closest({pad, home}, up_to).distance;
}

/// Returns whether a climb is close to a box in which unobserved space is occupied.
bool PadSearch::comes_near_unknown(const flight::Segment& climb) const {
  const bool is_dji = flight_.required_vehicle().autopilot == flight::AutopilotType::dji;
  const double margin = 2.0 * flight_.clearance + (is_dji ? flight::dji_lands_at_once : 0.0);
  return std::ranges::any_of(unknown_, [&](const AlignedBox3d& box) {
    return nearest(climb, box).squared_distance < margin * margin;
  });
}

}  // namespace skycap::missions::wizard
