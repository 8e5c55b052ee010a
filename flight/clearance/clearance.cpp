#include "flight/clearance/clearance.h"

#include <algorithm>
#include <cmath>

#include "flight/clearance/prior_obstacle.h"
#include "flight/clearance/triangle_tree.h"
#include "flight/clearance/winding.h"

namespace skycap::flight {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

}  // namespace

bool FreeSpace::is_free(const Segment& leg, double clearance) const {
  const Segment start{leg.from, leg.from};
  return closest(start, clearance + clearance_guard).kind == ObstacleKind::none &&
         continues_free(leg, clearance);
}

double FreeSpace::distance(const Vector3d& point, double up_to) const {
  return closest({point, point}, up_to).distance;
}

LegVerification verify(const FreeSpace& space, const Segment& leg, double clearance, double up_to) {
  const Closest closest = space.closest(leg, std::max(up_to, clearance + 2.0 * clearance_guard));
  const double verified_distance = std::max(0.0, closest.distance - clearance_guard);
  return {closest.distance - clearance_guard >= clearance, verified_distance, closest};
}

struct KnownSpace::Impl {
  TriangleTree mesh;
  TriangleTree rules;  ///< Boundaries of the no-fly volumes, then of the fence.
  /// No-fly volume of each triangle; no_fly.size() for the fence.
  std::vector<std::uint32_t> rule_owner;
  BoundingTree points_tree;
  PointObstacles cloud;
  WindingNumber winding;
  bool mesh_is_solid = false;
  std::vector<Prism> no_fly;
  std::optional<Prism> fence;
  std::optional<double> ground_height;
  std::vector<std::shared_ptr<const PriorObstacle>> priors;
  AlignedBox3d extent;

  explicit Impl(const Obstacles& obstacles);
  void add_rule(const Prism& prism, std::uint32_t owner);
  void find_triangles(const TriangleTree& tree, const Segment& leg, Closest& best) const;
  void find_points(const Segment& leg, Closest& best) const;
  void find_ground(const Segment& leg, Closest& best) const;
  Closest surface_closest(const Segment& leg, double up_to) const;
  void find_priors(const Segment& leg, Closest& best) const;
  std::optional<Closest> container(const Vector3d& point) const;
};

KnownSpace::Impl::Impl(const Obstacles& obstacles)
    : cloud(obstacles.cloud),
      mesh_is_solid(obstacles.mesh_is_solid),
      no_fly(obstacles.no_fly),
      fence(obstacles.fence),
      ground_height(obstacles.ground_height),
      priors(obstacles.priors) {
  mesh.triangles = to_triangles(obstacles.mesh);
  mesh.index();
  if (mesh_is_solid) winding = WindingNumber(mesh.tree, mesh.triangles);

  for (std::uint32_t i = 0; i < no_fly.size(); ++i) add_rule(no_fly[i], i);
  if (fence) add_rule(*fence, static_cast<std::uint32_t>(no_fly.size()));
  rules.index();

  std::vector<AlignedBox3d> boxes;
  boxes.reserve(cloud.points.size());
  const Vector3d radius = Vector3d::Constant(cloud.radius);
  for (const Eigen::Vector3f& point : cloud.points) {
    boxes.emplace_back(point.cast<double>() - radius, point.cast<double>() + radius);
    extent.extend(boxes.back());
  }
  points_tree = BoundingTree(boxes);
  if (!mesh.tree.empty()) extent.extend(mesh.tree.nodes()[0].box);
  for (const auto& prior : priors) {
    if (!prior->extent().isEmpty()) extent.extend(prior->extent());
  }
}

void KnownSpace::Impl::add_rule(const Prism& prism, std::uint32_t owner) {
  const std::vector<Triangle> triangles = to_triangles(surface(prism));
  rules.triangles.insert(rules.triangles.end(), triangles.begin(), triangles.end());
  rule_owner.resize(rules.triangles.size(), owner);
  for (const Triangle& triangle : triangles) {
    for (const Vector3d& corner : triangle) {
      // An unbounded prism cannot be flown over, so its distant ends are irrelevant for paths.
      if (std::abs(corner.z()) < 1e4) extent.extend(corner);
    }
  }
  if (std::isfinite(prism.floor) || std::isfinite(prism.ceiling)) return;
  for (const Eigen::Vector2d& corner : prism.footprint) {
    extent.extend(Vector3d(corner.x(), corner.y(), ground_height.value_or(0.0)));
  }
}

void KnownSpace::Impl::find_triangles(const TriangleTree& set, const Segment& leg,
                                      Closest& best) const {
  double reach = best.distance;
  set.visit_nearer(leg, reach, [&](std::uint32_t t, const NearestPoints& pair) {
    best = {reach, ObstacleKind::mesh, t, pair.on_segment, pair.on_other};
  });
}

void KnownSpace::Impl::find_points(const Segment& leg, Closest& best) const {
  double reach = best.distance;
  points_tree.visit_near(leg, reach, [&](std::uint32_t i) {
    const NearestPoints pair = nearest(leg, Vector3d(cloud.points[i].cast<double>()));
    const double to_centre = std::sqrt(pair.squared_distance);
    const double distance = std::max(0.0, to_centre - cloud.radius);
    if (!(distance < reach)) return;
    const Vector3d on_ball =
        distance > 0.0
            ? Vector3d(pair.on_other + cloud.radius / to_centre * (pair.on_segment - pair.on_other))
            : pair.on_segment;
    reach = distance;
    best = {distance, ObstacleKind::point, i, pair.on_segment, on_ball};
    if (reach == 0.0) reach = -1.0;
  });
}

void KnownSpace::Impl::find_ground(const Segment& leg, Closest& best) const {
  if (!ground_height) return;
  const Vector3d& lower_end = leg.from.z() < leg.to.z() ? leg.from : leg.to;
  const double height = std::max(0.0, lower_end.z() - *ground_height);
  if (!(height < best.distance)) return;
  best = {
      height, ObstacleKind::ground, 0, lower_end, {lower_end.x(), lower_end.y(), *ground_height}};
}

Closest KnownSpace::Impl::surface_closest(const Segment& leg, double up_to) const {
  Closest best{up_to};
  find_ground(leg, best);
  if (!rules.tree.empty()) {
    Closest rule = best;
    find_triangles(rules, leg, rule);
    if (rule.distance < best.distance) {
      const std::uint32_t owner = rule_owner[rule.index];
      const bool is_fence = owner == no_fly.size();
      best = rule;
      best.kind = is_fence ? ObstacleKind::fence : ObstacleKind::no_fly;
      best.index = is_fence ? 0 : owner;
    }
  }
  find_points(leg, best);
  find_triangles(mesh, leg, best);
  return best;
}

void KnownSpace::Impl::find_priors(const Segment& leg, Closest& best) const {
  for (std::uint32_t i = 0; i < priors.size(); ++i) {
    const Closest found = priors[i]->closest(leg, best.distance);
    if (!(found.distance < best.distance)) continue;
    best = found;
    best.owner = i;
  }
}

std::optional<Closest> KnownSpace::Impl::container(const Vector3d& point) const {
  for (std::uint32_t i = 0; i < no_fly.size(); ++i) {
    if (contains(no_fly[i], point)) return Closest{0.0, ObstacleKind::no_fly, i, point, point};
  }
  if (fence && !contains(*fence, point)) {
    return Closest{0.0, ObstacleKind::fence, 0, point, point};
  }
  const bool may_be_in_mesh = mesh_is_solid && !mesh.tree.empty();
  if (may_be_in_mesh && mesh.tree.nodes()[0].box.contains(point) &&
      winding.at(mesh.tree, mesh.triangles, point) > 0.5) {
    return Closest{0.0, ObstacleKind::mesh, 0, point, point};
  }
  return std::nullopt;
}

KnownSpace::KnownSpace(const Obstacles& obstacles) {
  validate(obstacles);
  impl_ = std::make_unique<Impl>(obstacles);
}

KnownSpace::~KnownSpace() = default;
KnownSpace::KnownSpace(KnownSpace&&) noexcept = default;
KnownSpace& KnownSpace::operator=(KnownSpace&&) noexcept = default;

Closest KnownSpace::closest(const Segment& leg, double up_to) const {
  Closest found = impl_->surface_closest(leg, up_to);
  if (found.distance > 0.0) impl_->find_priors(leg, found);
  if (found.distance == 0.0) return found;
  // The leg crosses no surface, so all of it is inside the same solid as its start.
  return impl_->container(leg.from).value_or(found);
}

bool KnownSpace::continues_free(const Segment& leg, double clearance) const {
  const double needed = clearance + clearance_guard;
  if (impl_->ground_height && std::min(leg.from.z(), leg.to.z()) - *impl_->ground_height < needed) {
    return false;
  }
  // Any item within the required distance ends the search, which is faster than finding the closest
  // one.
  bool is_free = true;
  double reach = needed;
  const auto meet = [&](double squared_distance, double min) {
    if (squared_distance >= min * min) return;
    is_free = false;
    reach = -1.0;
  };
  for (const TriangleTree* set : {&impl_->rules, &impl_->mesh}) {
    set->tree.visit_near(leg, reach, [&](std::uint32_t t) {
      if (!may_be_nearer(leg, set->triangles[t], needed)) return;
      meet(nearest(leg, set->triangles[t]).squared_distance, needed);
    });
    if (!is_free) return false;
  }
  impl_->points_tree.visit_near(leg, reach, [&](std::uint32_t i) {
    const Vector3d point = impl_->cloud.points[i].cast<double>();
    meet(nearest(leg, point).squared_distance, needed + impl_->cloud.radius);
  });
  return is_free && std::ranges::all_of(impl_->priors, [&](const auto& prior) {
           return prior->continues_free(leg, clearance);
         });
}

double KnownSpace::surface_distance(const Vector3d& point, double up_to) const {
  double distance = impl_->surface_closest({point, point}, up_to).distance;
  for (const auto& prior : impl_->priors) distance = prior->surface_distance(point, distance);
  return distance;
}

AlignedBox3d KnownSpace::extent() const { return impl_->extent; }

std::string KnownSpace::name(const Closest& closest) const {
  switch (closest.kind) {
    case ObstacleKind::mesh:
      return "triangle " + std::to_string(closest.index) + " of the scene";
    case ObstacleKind::point:
      return "point " + std::to_string(closest.index) + " of the cloud";
    case ObstacleKind::no_fly:
      return "no-fly volume \"" + impl_->no_fly.at(closest.index).name + "\"";
    case ObstacleKind::fence:
      return "fence \"" + impl_->fence->name + "\"";
    case ObstacleKind::ground:
      return "the ground";
    case ObstacleKind::prior:
      return impl_->priors.at(closest.owner)->name(closest);
    default:
      return "";
  }
}

double KnownSpace::winding_number(const Vector3d& point) const {
  if (!impl_->mesh_is_solid) return 0.0;
  return impl_->winding.at(impl_->mesh.tree, impl_->mesh.triangles, point);
}

Closest JointSpace::closest(const Segment& leg, double up_to) const {
  Closest best{up_to};
  for (const FreeSpace* space : spaces_) {
    const Closest found = space->closest(leg, best.distance);
    if (found.kind != ObstacleKind::none && found.distance < best.distance) best = found;
  }
  return best;
}

bool JointSpace::continues_free(const Segment& leg, double clearance) const {
  return std::all_of(spaces_.begin(), spaces_.end(),
                     [&](const FreeSpace* space) { return space->continues_free(leg, clearance); });
}

double JointSpace::surface_distance(const Vector3d& point, double up_to) const {
  for (const FreeSpace* space : spaces_) up_to = space->surface_distance(point, up_to);
  return up_to;
}

AlignedBox3d JointSpace::extent() const {
  AlignedBox3d extent;
  for (const FreeSpace* space : spaces_) {
    if (!space->extent().isEmpty()) extent.extend(space->extent());
  }
  return extent;
}

std::string JointSpace::name(const Closest& closest) const {
  for (const FreeSpace* space : spaces_) {
    if (std::string name = space->name(closest); !name.empty()) return name;
  }
  return "";
}

}  // namespace skycap::flight
