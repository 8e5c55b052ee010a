#include "missions/site/proposal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "flight/route/pad_check.h"
#include "flight/space/clearance.h"
#include "flight/way_home/return_law.h"
#include "geometry/error.h"
#include "missions/derived/mission_flight.h"
#include "missions/derived/mission_priors.h"
#include "missions/derived/pad_grounds.h"
#include "missions/derived/resolved_mission.h"
#include "missions/site/mission_text.h"
#include "missions/site/target.h"

namespace skycap::missions::site {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Trees, wires and people are beside buildings, and their files are off: so far around the target
/// at least nothing is vouched for [m].
constexpr double unknown_beside = 5.0, unknown_above = 3.0;

constexpr double clearance = 2.0;  ///< of legs [m]

double rounded_up(double value, double unit) { return std::ceil(value / unit) * unit; }

/// How closely a target is looked at: the larger it is, the less.
double registration_distance_of(const AlignedBox3d& target) {
  return std::clamp(rounded_up(target.sizes().maxCoeff() / 60.0, 0.05), 0.1, 1.0);
}

/// The box with its corners on multiples of a length, no smaller than it was.
AlignedBox3d rounded_out(const AlignedBox3d& box, double unit) {
  return {(box.min().array() / unit).floor() * unit, (box.max().array() / unit).ceil() * unit};
}

AlignedBox3d unknown_box(const Target& target, bool has_terrain) {
  const double beside = std::max(unknown_beside, target.uncertainty);
  AlignedBox3d box = target.box;
  box.min().array() -= beside;
  box.max().array() += beside;
  box.max().z() = target.box.max().z() + std::max(unknown_above, target.uncertainty);
  box.min().z() = has_terrain ? -beside : 0.0;  // ground may fall away beside it
  return rounded_out(box, 1.0);
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
  return rounded_out(fence, 1.0);
}

/// Where the vehicle may take off and land, by all that the files hold.
class Pads {
 public:
  /// `top` is where climbs end. The fence is put around the pad afterwards.
  Pads(const file::Mission& mission, double top)
      : mission_(mission),
        top_(top),
        space_(without_fence(derived::flight_rules(mission))),
        pad_space_(without_ground(without_fence(derived::flight_rules(mission)))) {}

  /// On the ground there; nothing where the terrain's files have none.
  std::optional<Vector3d> at(const Vector2d& place) const {
    const auto& terrain = derived::priors_of(mission_).terrain;
    const std::optional<double> ground = terrain ? terrain->height(place) : 0.0;
    if (!ground) return std::nullopt;
    return Vector3d(place.x(), place.y(), std::round(100.0 * *ground) / 100.0);
  }

  /// How near the climb from a pad comes to what stands beside it, up to `up_to`; 0 if the pad is
  /// not one.
  double room_over(const Vector3d& pad, double up_to) const {
    flight::RouteOptions options = derived::route_options_of(mission_, pad);
    options.grounds = derived::grounds_of(mission_, pad, {});
    options.takeoff_climb = std::max(options.takeoff_climb, top_ - pad.z());
    try {
      check_pad(space_, &pad_space_, options);
    } catch (const Error&) {
      return 0.0;
    }
    const Vector3d home = pad + options.takeoff_climb * Vector3d::UnitZ();
    return pad_space_.closest({pad, home}, up_to).distance;
  }

 private:
  static flight::Obstacles without_fence(flight::Obstacles rules) {
    rules.fence.reset();
    return rules;
  }

  const file::Mission& mission_;
  double top_;
  flight::KnownSpace space_, pad_space_;
};

/// On the ground beside the unknown box, with nothing known over it or near it up to the top of the
/// fence: as near as there is room, and there where most of it is.
std::optional<Vector3d> find_pad(const file::Mission& mission, const AlignedBox3d& unknown,
                                 double top) {
  const Pads pads(mission, top);
  const bool is_dji = derived::vehicle_of(mission).dialect == flight::Dialect::dji;
  const double first = 2.0 * clearance + 1.0 + (is_dji ? flight::dji_lands_at_once : 0.0);
  constexpr int directions = 16;
  constexpr double step = 5.0, farthest = 100.0, wanted = 3.0 * clearance;
  const Vector2d middle = unknown.center().head<2>();
  const Vector2d corner = 0.5 * std::numbers::sqrt2 * unknown.sizes().head<2>();
  for (double beside = first; beside <= farthest; beside += step) {
    Vector3d best = Vector3d::Zero();
    double most_room = wanted;
    for (int i = 0; i < directions; ++i) {
      const double azimuth = 2.0 * std::numbers::pi * i / directions;
      const Vector2d way(-std::sin(azimuth), -std::cos(azimuth));  // southward first
      const Vector2d place = middle + way.cwiseProduct(corner) + beside * way;
      const auto pad = pads.at({std::round(place.x()), std::round(place.y())});
      if (!pad) continue;
      const double room = pads.room_over(*pad, 2.0 * wanted);
      if (room <= most_room) continue;
      best = *pad;
      most_room = room;
    }
    if (most_room > wanted) return best;
  }
  return std::nullopt;
}

}  // namespace

std::string propose_mission(const Wishes& wishes, const std::filesystem::path& file) {
  const std::vector<prior::Source> files = files_of(wishes);
  const Target target = find_target(files, wishes.target);
  MissionValues values{.file = file,
                       .vehicle = wishes.vehicle,
                       .sources = sources_of(files, target.ids),
                       .origin = target.origin,
                       .unknown = unknown_box(target, wishes.terrain.has_value()),
                       .clearance = clearance,
                       .registration_distance = registration_distance_of(target.box)};
  values.view_distance = std::round(std::clamp(target.box.sizes().maxCoeff(), 10.0, 25.0));
  values.fence = fence_around(values.unknown, std::nullopt, values.view_distance);
  const file::Mission mission = derived::parse_mission(mission_text(values), file.string());
  values.scene = rounded_out(mission.planner.see.scene_box.value(), 0.1);
  values.pad = find_pad(mission, values.unknown, values.fence.max().z() - clearance);
  if (!values.pad) {
    throw Error(ErrorKind::bad_config,
                wishes.map.string() +
                    ": leaves no room for a pad within 100 m of the target, by what stands there "
                    "and how steep and even the ground is; what is in the way may be left out by "
                    "select");
  }
  values.fence = fence_around(values.unknown, values.pad, values.view_distance);
  return mission_text(values);
}

}  // namespace skycap::missions::site
