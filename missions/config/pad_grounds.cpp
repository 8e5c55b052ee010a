#include "missions/config/pad_grounds.h"

#include <algorithm>
#include <optional>

#include "flight/space/prior_obstacle.h"
#include "missions/config/mission_flight.h"
#include "missions/config/mission_priors.h"

namespace skycap::missions::config {
namespace {

using Eigen::Vector3d;
using flight::PadGround;

std::optional<PadGround> ground_by_terrain(const config::Mission& mission, const Vector3d& place) {
  const auto& terrain = priors_of(mission).terrain;
  if (!terrain) return std::nullopt;
  std::vector<Vector3d> heights;
  for (const Eigen::Vector2d& at : flight::places_on(place, pad_radius_of(mission))) {
    if (const auto height = terrain->height(at)) heights.emplace_back(at.x(), at.y(), *height);
  }
  return flight::pad_ground(place, heights, flight::GroundSource::terrain);
}

}  // namespace

double pad_radius_of(const config::Mission& mission) {
  return vehicle_of(mission).radius + mission.flight.position_error;
}

std::vector<Vector3d> landings_of(const config::Mission& mission, const Vector3d& pad) {
  std::vector<Vector3d> landings{pad};
  landings.insert(landings.end(), mission.flight.rally.begin(), mission.flight.rally.end());
  return landings;
}

std::vector<PadGround> grounds_of(const config::Mission& mission, const Vector3d& pad,
                                  std::span<const PadGround> measured) {
  std::vector<PadGround> grounds;
  for (const Vector3d& place : landings_of(mission, pad)) {
    const auto known = std::ranges::find(measured, place, &PadGround::place);
    if (known != measured.end()) {
      grounds.push_back(*known);
    } else if (mission.flight.pad_slope) {
      grounds.push_back(
          {place, *mission.flight.pad_slope, 0.0, 0.0, flight::GroundSource::declared});
    } else if (const auto ground = ground_by_terrain(mission, place)) {
      grounds.push_back(*ground);
    }
  }
  return grounds;
}

flight::PadLimits ground_limits_of(const config::Mission& mission) {
  flight::PadLimits limits{mission.flight.steepest_pad, 0.0};
  for (const auto& obstacle : priors_of(mission).obstacles) {
    if (!obstacle->is_ground()) continue;
    limits.height_error = std::max(limits.height_error, obstacle->uncertainty());
  }
  return limits;
}

}  // namespace skycap::missions::config
