#include "missions/wizard/pad_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "flight/route/pad_check.h"
#include "flight/space/segment_distance.h"
#include "flight/way_home/return_law.h"
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

PadSearch::PadSearch(flight::FlightOptions flight, std::vector<AlignedBox3d> unknown)
    : flight_(std::move(flight)),
      unknown_(std::move(unknown)),
      space_(without_fence(flight_.rules())),
      pad_space_(without_ground(without_fence(flight_.rules()))) {}

std::optional<Vector3d> PadSearch::beside(const AlignedBox3d& unknown, double top) const {
  const bool is_dji = flight_.flown().dialect == flight::Dialect::dji;
  const double clearance = flight_.clearance;
  const double first = 2.0 * clearance + 1.0 + (is_dji ? flight::dji_lands_at_once : 0.0);
  constexpr int directions = 16;
  constexpr double step = 5.0, farthest = 100.0;
  const double wanted = 3.0 * clearance;
  const Vector2d middle = unknown.center().head<2>();
  const Vector2d corner = 0.5 * std::numbers::sqrt2 * unknown.sizes().head<2>();
  for (int steps = 0; first + steps * step <= farthest; ++steps) {
    const double beside = first + steps * step;
    Vector3d best = Vector3d::Zero();
    double most_room = wanted;
    for (int i = 0; i < directions; ++i) {
      const double azimuth = 2.0 * std::numbers::pi * i / directions;
      const Vector2d way(-std::sin(azimuth), -std::cos(azimuth));  // starts in the south
      const Vector2d place = middle + way.cwiseProduct(corner) + beside * way;
      const auto pad = at({std::round(place.x()), std::round(place.y())});
      if (!pad) continue;
      const double room = room_over(*pad, top, 2.0 * wanted);
      if (room <= most_room) continue;
      best = *pad;
      most_room = room;
    }
    if (most_room > wanted) return best;
  }
  return std::nullopt;
}

std::optional<Vector3d> PadSearch::at(const Vector2d& place) const {
  const flight::AirspaceOptions& airspace = flight_.airspace;
  const std::optional<double> ground =
      airspace.terrain ? airspace.terrain(place) : airspace.base.z();
  if (!ground) return std::nullopt;
  return Vector3d(place.x(), place.y(), std::round(100.0 * *ground) / 100.0);
}

double PadSearch::room_over(const Vector3d& pad, double top, double up_to) const {
  flight::RouteOptions options = flight_.route(pad);
  options.grounds = flight_.grounds(pad, {});
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
  const bool is_dji = flight_.flown().dialect == flight::Dialect::dji;
  const double spare = 2.0 * flight_.clearance + (is_dji ? flight::dji_lands_at_once : 0.0);
  return std::ranges::any_of(unknown_, [&](const AlignedBox3d& box) {
    return nearest(climb, box).squared_distance < spare * spare;
  });
}

}  // namespace skycap::missions::wizard
