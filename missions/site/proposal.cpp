#include "missions/site/proposal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "flight/space/clearance.h"
#include "flight/way_home/return_law.h"
#include "geometry/error.h"
#include "missions/derived/mission_flight.h"
#include "missions/derived/mission_priors.h"
#include "missions/derived/resolved_mission.h"
#include "missions/site/mission_text.h"
#include "missions/site/target.h"

namespace skycap::missions::site {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Trees, wires and people are beside buildings, and their files are off: so far around the target
/// nothing is vouched for [m].
constexpr double unknown_beside = 5.0, unknown_above = 3.0;

constexpr double clearance = 2.0;  ///< of legs [m]

double rounded_up(double value, double unit) { return std::ceil(value / unit) * unit; }

/// How closely a target is looked at: the larger it is, the less.
double registration_distance_of(const AlignedBox3d& target) {
  return std::clamp(rounded_up(target.sizes().maxCoeff() / 60.0, 0.05), 0.1, 1.0);
}

AlignedBox3d unknown_box(const AlignedBox3d& target, bool has_terrain) {
  AlignedBox3d box = target;
  box.min().array() -= unknown_beside;
  box.max().array() += unknown_beside;
  box.max().z() = target.max().z() + unknown_above;
  box.min().z() = has_terrain ? -unknown_beside : 0.0;  // ground may fall away beside it
  for (int axis = 0; axis < 3; ++axis) {
    box.min()[axis] = std::floor(box.min()[axis]);
    box.max()[axis] = std::ceil(box.max()[axis]);
  }
  return box;
}

/// The target and what it may be off, but not the ground.
AlignedBox3d scene_box(const AlignedBox3d& target, double registration_distance) {
  AlignedBox3d box = target;
  box.min().array() -= derived::beside_targets;
  box.max().array() += derived::beside_targets;
  box.min().z() = target.min().z() + 2.0 * registration_distance;
  for (int axis = 0; axis < 3; ++axis) {
    box.min()[axis] = std::round(10.0 * box.min()[axis]) / 10.0;
    box.max()[axis] = std::round(10.0 * box.max()[axis]) / 10.0;
  }
  return box;
}

/// A fence around a box and a pad.
AlignedBox3d fence_around(const AlignedBox3d& unknown, const std::optional<Vector3d>& pad,
                          double view_distance) {
  constexpr double spare = 10.0;
  AlignedBox3d fence = unknown;
  fence.min().array() -= view_distance + spare;
  fence.max().array() += view_distance + spare;
  if (pad)
    fence.extend(AlignedBox3d(*pad - Vector3d(spare, spare, 0), *pad + Vector3d(spare, spare, 0)));
  for (int axis = 0; axis < 3; ++axis) {
    fence.min()[axis] = std::floor(fence.min()[axis]);
    fence.max()[axis] = std::ceil(fence.max()[axis]);
  }
  return fence;
}

/// On the ground beside the unknown box, with nothing known over it or near it up to the top of the
/// fence: as near as there is room, and there where most of it is.
std::optional<Vector3d> find_pad(const file::Mission& mission, const AlignedBox3d& unknown,
                                 double top) {
  flight::Obstacles rules = without_ground(derived::flight_rules(mission));
  rules.fence.reset();  // it is put around the pad afterwards
  const flight::KnownSpace space(rules);
  const bool is_dji = derived::vehicle_of(mission).dialect == flight::Dialect::dji;
  const double first = 2.0 * clearance + 1.0 + (is_dji ? flight::dji_lands_at_once : 0.0);
  constexpr int directions = 16;
  constexpr double step = 5.0, farthest = 100.0, wanted = 3.0 * clearance;
  for (double beside = first; beside <= farthest; beside += step) {
    std::optional<Vector3d> best;
    double most_room = wanted;
    for (int i = 0; i < directions; ++i) {
      const double azimuth = 2.0 * std::numbers::pi * i / directions;
      const Vector2d way(-std::sin(azimuth), -std::cos(azimuth));  // southward first
      const Vector2d half = 0.5 * unknown.sizes().head<2>();
      const Vector2d place =
          unknown.center().head<2>() + way.cwiseProduct(half * std::numbers::sqrt2) + beside * way;
      Vector3d pad(std::round(place.x()), std::round(place.y()), 0.0);
      pad.z() = std::round(100.0 * derived::ground_at(mission, pad.head<2>())) / 100.0;
      const flight::Segment climb{pad, Vector3d(pad.x(), pad.y(), std::max(top, pad.z()))};
      const double room = space.closest(climb, 2.0 * wanted).distance;
      if (room <= most_room) continue;
      best = pad;
      most_room = room;
    }
    if (best) return best;
  }
  return std::nullopt;
}

}  // namespace

std::string propose_mission(const Wishes& wishes, const std::filesystem::path& file) {
  const Target target = find_target(wishes);
  MissionValues values{.file = file,
                       .vehicle = wishes.vehicle,
                       .sources = sources_of(wishes, target.ids),
                       .origin = target.origin,
                       .scene = scene_box(target.box, registration_distance_of(target.box)),
                       .unknown = unknown_box(target.box, wishes.terrain.has_value()),
                       .clearance = clearance,
                       .registration_distance = registration_distance_of(target.box)};
  values.view_distance = std::round(std::clamp(target.box.sizes().maxCoeff(), 10.0, 25.0));
  values.fence = fence_around(values.unknown, std::nullopt, values.view_distance);
  const file::Mission mission = derived::parse_mission(mission_text(values), file.string());
  values.pad = find_pad(mission, values.unknown, values.fence.max().z() - clearance);
  if (!values.pad) {
    throw Error(ErrorKind::bad_config,
                wishes.map.string() +
                    ": leaves no room for a pad within 100 m of the target; what is in the way "
                    "there may be left out by select");
  }
  values.fence = fence_around(values.unknown, values.pad, values.view_distance);
  return mission_text(values);
}

}  // namespace skycap::missions::site
