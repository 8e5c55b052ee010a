#include "flight/clearance/obstacles.h"

#include <algorithm>
#include <cmath>

#include "flight/clearance/prior_obstacle.h"
#include "geometry/error.h"
#include "geometry/surfaces/ear_clipping.h"

namespace skycap::flight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::turn;

constexpr double far_away = 1e5;  // Represents an infinite floor or ceiling [m].

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double signed_area(const std::vector<Vector2d>& polygon) {
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    area += 0.5 * cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
  }
  return area;
}

bool properly_cross(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  return turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0;
}

void validate(const Prism& prism, const std::string& role) {
  const std::string who = role + " \"" + prism.name + "\"";
  const auto& corners = prism.footprint;
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::bad_config, who + " " + what);
  };
  if (corners.size() < 3) {
    fail("has " + std::to_string(corners.size()) + " corners; a footprint requires at least 3");
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!corners[i].allFinite()) fail("has a corner with a non-finite coordinate");
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      if (properly_cross(corners[i], corners[(i + 1) % corners.size()], corners[j],
                         corners[(j + 1) % corners.size()])) {
        fail("crosses itself between corners " + std::to_string(i) + " and " + std::to_string(j) +
             "; a footprint must be a simple polygon");
      }
    }
  }
  if (!(std::abs(signed_area(corners)) > 0.0)) fail("has no area");
  if (!(prism.floor < prism.ceiling)) {
    fail("has its floor at " + std::to_string(prism.floor) +
         " m, which must be below its ceiling at " + std::to_string(prism.ceiling) + " m");
  }
}

}  // namespace

void validate(const Obstacles& obstacles) {
  // An empty mesh is permitted. Vertices without triangles, and triangles without area, are errors.
  if (!obstacles.mesh.triangles.empty() || !obstacles.mesh.vertices.empty()) {
    geometry::validate(obstacles.mesh);
  }
  for (std::size_t i = 0; i < obstacles.cloud.points.size(); ++i) {
    if (!obstacles.cloud.points[i].allFinite()) {
      throw Error(ErrorKind::bad_geometry,
                  "obstacle point " + std::to_string(i) + " has a non-finite coordinate");
    }
  }
  if (!(obstacles.cloud.radius >= 0.0) || !std::isfinite(obstacles.cloud.radius)) {
    throw Error(ErrorKind::bad_config, "the obstacle points' radius is " +
                                           std::to_string(obstacles.cloud.radius) +
                                           " m; it must be a finite number, zero or more");
  }
  for (const Prism& prism : obstacles.no_fly) validate(prism, "no-fly volume");
  if (obstacles.ground_height && !std::isfinite(*obstacles.ground_height)) {
    throw Error(ErrorKind::bad_config, "the ground height is not a finite number");
  }
  if (!obstacles.fence) return;
  validate(*obstacles.fence, "fence");
  if (obstacles.ground_height && obstacles.fence->ceiling <= *obstacles.ground_height) {
    throw Error(ErrorKind::bad_config, "fence \"" + obstacles.fence->name +
                                           "\" has its ceiling at " +
                                           std::to_string(obstacles.fence->ceiling) +
                                           " m, which must be above the ground at " +
                                           std::to_string(*obstacles.ground_height) + " m");
  }
}

Obstacles without_ground(Obstacles obstacles) {
  obstacles.ground_height.reset();
  std::erase_if(obstacles.priors, [](const auto& prior) { return prior->is_ground(); });
  if (obstacles.fence) obstacles.fence->floor = -std::numeric_limits<double>::infinity();
  return obstacles;
}

geometry::Mesh surface(const Prism& prism) {
  std::vector<Vector2d> corners = prism.footprint;
  if (signed_area(corners) < 0.0) std::reverse(corners.begin(), corners.end());
  const double floor = std::max(prism.floor, -far_away);
  const double ceiling = std::min(prism.ceiling, far_away);
  const auto count = static_cast<std::uint32_t>(corners.size());

  geometry::Mesh mesh;
  for (const double height : {floor, ceiling}) {
    for (const Vector2d& corner : corners) {
      mesh.vertices.emplace_back(corner.x(), corner.y(), height);
    }
  }
  for (const auto& [a, b, c] : geometry::clip_ears(corners)) {
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({a + count, b + count, c + count});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    mesh.triangles.push_back({i, next, next + count});
    mesh.triangles.push_back({i, next + count, i + count});
  }
  return mesh;
}

}  // namespace skycap::flight
