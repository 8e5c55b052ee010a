#include "flight/clearance/prior_obstacle.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "flight/clearance/triangle_tree.h"
#include "flight/clearance/winding.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Represents the missing lower end of a column [m].
constexpr double bottomless = -1e5;

/// Represents the missing far side of a column [m].
constexpr double without_end = 2e4;

struct Part {
  std::string name;
  TriangleTree mesh;
  WindingNumber winding;

  explicit Part(const NamedSurface& surface) : name(surface.name) {
    mesh.triangles = to_triangles(surface.mesh);
    mesh.index();
    winding = WindingNumber(mesh.tree, mesh.triangles);
  }
  const AlignedBox3d& box() const { return mesh.tree.nodes()[0].box; }
  bool contains(const Vector3d& point) const {
    return box().contains(point) && winding.at(mesh.tree, mesh.triangles, point) > 0.5;
  }
};

/// Returns the column extended downwards, so that its lower end is unreachable.
AlignedBox3d endless(AlignedBox3d column) {
  column.min().z() = bottomless;
  return column;
}

}  // namespace

void PriorObstacleConfig::validate() const {
  const auto reject = [&](ErrorKind kind, const std::string& what) {
    throw Error(kind, name + " " + what);
  };
  const auto is_length = [](double length) { return length >= 0.0 && std::isfinite(length); };
  if (!is_length(uncertainty)) {
    reject(ErrorKind::bad_config, "has an uncertainty of " + std::to_string(uncertainty) +
                                      " m; it must be a finite number, zero or more");
  }
  if (!is_length(point_radius)) {
    reject(ErrorKind::bad_config, "has points of radius " + std::to_string(point_radius) +
                                      " m; it must be a finite number, zero or more");
  }
  for (const NamedSurface& surface : surfaces) geometry::validate(surface.mesh);
  if (!std::ranges::all_of(points, [](const auto& point) { return point.allFinite(); })) {
    reject(ErrorKind::bad_geometry, "has a non-finite point");
  }
  const auto is_sound = [](const AlignedBox3d& box) {
    return box.min().allFinite() && box.max().allFinite() && !box.isEmpty();
  };
  if (!std::ranges::all_of(columns, is_sound)) {
    reject(ErrorKind::bad_geometry, "has an empty or non-finite column");
  }
}

struct PriorObstacle::Impl {
  explicit Impl(const PriorObstacleConfig& config);
  /// Finds the closest obstacle whose distance, before subtraction of the uncertainty, is below
  /// that of `best`.
  void find(const Segment& leg, Closest& best) const;
  void find_parts(const Segment& leg, double& reach, Closest& best) const;
  void find_points(const Segment& leg, double& reach, Closest& best) const;
  void find_columns(const Segment& leg, double& reach, Closest& best) const;
  Closest widened(Closest found, double up_to) const;
  /// Returns the part that contains the point.
  std::optional<std::uint32_t> container(const Vector3d& point) const;

  std::string name;
  double uncertainty;
  bool is_ground;
  std::vector<Part> parts;
  BoundingTree parts_tree;
  std::vector<Eigen::Vector3f> points;
  double radius;
  BoundingTree points_tree;
  std::vector<AlignedBox3d> columns;
  BoundingTree columns_tree;
  AlignedBox3d extent;
};

PriorObstacle::Impl::Impl(const PriorObstacleConfig& config)
    : name(config.name),
      uncertainty(config.uncertainty),
      is_ground(config.is_ground || config.surfaces.empty()),
      points(config.points),
      radius(config.point_radius) {
  std::vector<AlignedBox3d> boxes;
  for (const NamedSurface& surface : config.surfaces) {
    if (surface.mesh.triangles.empty()) continue;
    boxes.push_back(parts.emplace_back(surface).box());
    extent.extend(boxes.back());
  }
  parts_tree = BoundingTree(boxes);
  boxes.clear();
  for (const Eigen::Vector3f& point : points) {
    const Vector3d centre = point.cast<double>(), reach = Vector3d::Constant(radius);
    boxes.emplace_back(centre - reach, centre + reach);
    extent.extend(boxes.back());
  }
  points_tree = BoundingTree(boxes);
  columns.reserve(config.columns.size());
  for (const AlignedBox3d& column : config.columns) {
    // An unbounded column cannot be flown around, so its distant ends are irrelevant for paths.
    const double farthest = column.min().cwiseAbs().cwiseMax(column.max().cwiseAbs()).maxCoeff();
    if (farthest < without_end) extent.extend(column);
    columns.push_back(endless(column));
  }
  columns_tree = BoundingTree(columns);
  if (extent.isEmpty()) return;
  extent.min().array() -= uncertainty;
  extent.max().array() += uncertainty;
}

void PriorObstacle::Impl::find_parts(const Segment& leg, double& reach, Closest& best) const {
  parts_tree.visit_near(leg, reach, [&](std::uint32_t p) {
    parts[p].mesh.visit_nearer(leg, reach, [&](std::uint32_t, const NearestPoints& pair) {
      best = {reach, ObstacleKind::prior, p, pair.on_segment, pair.on_other};
    });
  });
}

void PriorObstacle::Impl::find_points(const Segment& leg, double& reach, Closest& best) const {
  points_tree.visit_near(leg, reach, [&](std::uint32_t i) {
    const NearestPoints pair = nearest(leg, Vector3d(points[i].cast<double>()));
    const double distance = std::max(0.0, std::sqrt(pair.squared_distance) - radius);
    if (!(distance < reach)) return;
    reach = distance > 0.0 ? distance : -1.0;
    best = {distance, ObstacleKind::prior, static_cast<std::uint32_t>(parts.size()),
            pair.on_segment, pair.on_other};
  });
}

void PriorObstacle::Impl::find_columns(const Segment& leg, double& reach, Closest& best) const {
  columns_tree.visit_near(leg, reach, [&](std::uint32_t i) {
    const NearestPoints pair = nearest(leg, columns[i]);
    if (!(pair.squared_distance < reach * reach)) return;
    const double distance = std::sqrt(pair.squared_distance);
    reach = distance > 0.0 ? distance : -1.0;
    best = {distance, ObstacleKind::prior, static_cast<std::uint32_t>(parts.size()),
            pair.on_segment, pair.on_other};
  });
}

void PriorObstacle::Impl::find(const Segment& leg, Closest& best) const {
  double reach = best.distance;
  find_parts(leg, reach, best);
  if (reach > 0.0) find_points(leg, reach, best);
  if (reach > 0.0) find_columns(leg, reach, best);
}

std::optional<std::uint32_t> PriorObstacle::Impl::container(const Vector3d& point) const {
  std::optional<std::uint32_t> container;
  double touching = clearance_guard;
  parts_tree.visit_near({point, point}, touching, [&](std::uint32_t p) {
    if (!parts[p].contains(point)) return;
    container = p;
    touching = -1.0;
  });
  return container;
}

Closest PriorObstacle::Impl::widened(Closest found, double up_to) const {
  if (found.kind == ObstacleKind::none) return Closest{up_to};
  found.distance = std::max(0.0, found.distance - uncertainty);
  return found;
}

PriorObstacle::PriorObstacle(const PriorObstacleConfig& config) {
  config.validate();
  impl_ = std::make_unique<const Impl>(config);
}

PriorObstacle::~PriorObstacle() = default;

Closest PriorObstacle::closest(const Segment& leg, double up_to) const {
  Closest best{up_to + impl_->uncertainty};
  impl_->find(leg, best);
  if (best.distance > 0.0) {
    // The leg crosses no surface, so all of it is inside the same solid as its start.
    if (const auto part = impl_->container(leg.from)) {
      return {0.0, ObstacleKind::prior, *part, leg.from, leg.from};
    }
  }
  return impl_->widened(best, up_to);
}

bool PriorObstacle::continues_free(const Segment& leg, double clearance) const {
  Closest best{clearance + clearance_guard + impl_->uncertainty};
  impl_->find(leg, best);
  return best.kind == ObstacleKind::none;
}

double PriorObstacle::surface_distance(const Vector3d& point, double up_to) const {
  Closest best{up_to + impl_->uncertainty};
  impl_->find({point, point}, best);
  return impl_->widened(best, up_to).distance;
}

AlignedBox3d PriorObstacle::extent() const { return impl_->extent; }

std::string PriorObstacle::name(const Closest& closest) const {
  if (closest.kind != ObstacleKind::prior) return "";
  const std::string part =
      closest.index < impl_->parts.size() ? impl_->parts[closest.index].name : "";
  return part.empty() ? impl_->name : part + " of " + impl_->name;
}

double PriorObstacle::uncertainty() const { return impl_->uncertainty; }

bool PriorObstacle::is_ground() const { return impl_->is_ground; }

}  // namespace skycap::flight
