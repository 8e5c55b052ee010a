#include "tests/survey/volumetric/octomap_planning.h"

#include <cmath>

namespace skycap::tests {
namespace {

using enum survey::volumetric::VolumetricMetric;
using survey::volumetric::VolumetricMetric;

octomap::point3d octomap_point(const Eigen::Vector3f& p) { return {p.x(), p.y(), p.z()}; }

double entropy(double p) { return -p * std::log(p) - (1.0 - p) * std::log(1.0 - p); }

/// A voxel on a ray. Unmeasured voxels have the prior.
struct RayVoxel {
  double p = 0.5;
  bool exists = false;
  bool is_measured = false;
  int shadow_depth = 0;

  bool is_free() const { return p < 0.2; }
  bool is_occupied() const { return p > 0.8; }
  bool is_uncertain() const { return !is_free() && !is_occupied(); }
};

double visible_entropy(const std::vector<RayVoxel>& ray, bool only_uncertain) {
  double sum = 0.0, visibility = 1.0;
  for (const RayVoxel& voxel : ray) {
    if (!only_uncertain || voxel.is_uncertain()) sum += visibility * entropy(voxel.p);
    visibility *= voxel.p;
  }
  return sum;
}

double rear_side_voxels(const std::vector<RayVoxel>& ray) {
  double count = 0.0;
  bool is_uncertain_before = false;
  for (const RayVoxel& voxel : ray) {
    if (voxel.is_occupied() && is_uncertain_before) ++count;
    is_uncertain_before = voxel.is_uncertain();
  }
  return count;
}

double compute_rear_side_entropy(const std::vector<RayVoxel>& ray) {
  if (!ray.back().is_occupied()) return 0.0;
  double sum = 0.0, visibility = 1.0;
  for (std::size_t i = 0; i + 1 < ray.size(); ++i) {
    sum = ray[i].is_uncertain() ? sum + visibility * entropy(ray[i].p) : 0.0;
    visibility *= ray[i].p;
  }
  return sum + visibility * entropy(ray.back().p);
}

double reward(double x, double a) {
  if (x <= a) return -2.0 / (a * a * a) * x * x * x + 3.0 / (a * a) * x * x;
  return (-2.0 * x * x * x + 3.0 * (a + 1.0) * x * x - 6.0 * a * x + (3.0 * a - 1.0)) /
         std::pow(a - 1.0, 3);
}

/// Sums over the rays of a view for metrics that are not plain sums.
struct ViewSums {
  double sum = 0.0, voxels = 0.0;
  double occupied = 0.0, shadowed = 0.0, unobserved = 0.0;
  bool nothing_known_yet = true;
};

void vote(const std::vector<RayVoxel>& ray, ViewSums& view) {
  bool from_free = true;
  for (const RayVoxel& voxel : ray) {
    if (!voxel.exists) {
      from_free = view.nothing_known_yet;
    } else if (!voxel.is_measured) {
      ++view.shadowed;
      return;
    } else {
      view.nothing_known_yet = false;
      if (voxel.is_occupied()) {
        if (from_free) ++view.occupied;
        return;
      }
      from_free = voxel.is_free();
    }
  }
  ++view.unobserved;
}

void add_ray(VolumetricMetric metric, const std::vector<RayVoxel>& ray, double max_shadow,
             ViewSums& view) {
  switch (metric) {
    case rear_side_voxel:
      view.sum += rear_side_voxels(ray);
      break;
    case rear_side_entropy:
      view.sum += compute_rear_side_entropy(ray);
      break;
    case occlusion_aware:
      view.sum += visible_entropy(ray, false);
      break;
    case unobserved_voxel:
      view.sum += visible_entropy(ray, true);
      break;
    case proximity_count:
      for (const RayVoxel& voxel : ray) {
        if (voxel.shadow_depth > 0) view.sum += max_shadow - voxel.shadow_depth;
      }
      break;
    case area_factor:
      vote(ray, view);
      break;
    case average_entropy:
      if (!ray.back().is_occupied()) break;
      for (const RayVoxel& voxel : ray) view.sum += entropy(voxel.p);
      view.voxels += static_cast<double>(ray.size());
      break;
  }
}

}  // namespace

ShadowTree::ShadowTree(double its_resolution, double shadow_length)
    : octomap::OccupancyOcTreeBase<ShadowNode>(its_resolution), shadow_length_(shadow_length) {
  setProbHit(0.7);
  setProbMiss(0.4);
  setClampingThresMin(0.12);
  setClampingThresMax(0.97);
}

void ShadowTree::insert(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> points) {
  octomap::Pointcloud cloud;
  for (const Eigen::Vector3f& point : points) cloud.push_back(octomap_point(point));
  octomap::KeySet passed, hit;
  computeUpdate(cloud, octomap_point(origin), passed, hit, -1.0);
  for (const octomap::OcTreeKey& key : passed) measure(key, false);
  for (const octomap::OcTreeKey& key : hit) measure(key, true);

  octomap::KeyRay ray;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f displacement = point - origin;
    const Eigen::Vector3f end =
        point + displacement * (static_cast<float>(shadow_length_) / displacement.norm());
    computeRayKeys(octomap_point(point), octomap_point(end), ray);
    int depth = 0;
    for (const octomap::OcTreeKey& key : ray) {
      if (depth++ == 0) continue;  // voxel of the surface itself
      ShadowNode* node = search(key);
      if (!node) {
        node = updateNode(key, false, true);
        node->is_measured = false;
        node->shadow_depth = depth - 1;
      } else if (!node->is_measured) {
        node->shadow_depth = std::min(node->shadow_depth, depth - 1);
      }
    }
  }
}

void ShadowTree::measure(const octomap::OcTreeKey& key, bool is_hit) {
  ShadowNode* node = search(key);
  if (node && !node->is_measured) {
    node->setLogOdds(is_hit ? getProbHitLog() : getProbMissLog());
    node->is_measured = true;
    node->shadow_depth = 0;
  } else {
    updateNode(key, is_hit, true);
  }
}

double ShadowTree::gain(VolumetricMetric metric, const geometry::View& view,
                        const std::vector<Eigen::Vector3d>& directions, double depth,
                        bool aims_at_centres) const {
  const Eigen::Matrix3d world_from_camera = geometry::camera_pose(view).linear();
  const octomap::point3d origin = octomap_point(view.position.cast<float>());
  const double max_shadow = 2.0 * shadow_length_ / resolution;
  const auto to_voxel = [&](const octomap::OcTreeKey& key) {
    const ShadowNode* node = search(key);
    if (!node) return RayVoxel{};
    if (!node->is_measured) return RayVoxel{0.5, true, false, node->shadow_depth};
    return RayVoxel{node->getOccupancy(), true, true, 0};
  };
  ViewSums sums;
  octomap::KeyRay keys;
  std::vector<RayVoxel> ray;
  for (const Eigen::Vector3d& in_camera : directions) {
    const Eigen::Vector3d direction = world_from_camera * in_camera;
    octomap::point3d end = octomap_point((view.position + depth * direction).cast<float>());
    octomap::point3d surface;
    if (aims_at_centres &&
        castRay(origin, octomap_point(direction.cast<float>()), surface, true, depth)) {
      end = surface;
    }
    ray.clear();
    computeRayKeys(origin, end, keys);
    for (const octomap::OcTreeKey& key : keys) {
      ray.push_back(to_voxel(key));
      if (!aims_at_centres && ray.back().is_measured && ray.back().p >= 0.5) break;
    }
    const bool has_met_surface =
        !aims_at_centres && !ray.empty() && ray.back().is_measured && ray.back().p >= 0.5;
    if (!has_met_surface) ray.push_back(to_voxel(coordToKey(end)));
    add_ray(metric, ray, max_shadow, sums);
  }
  if (metric == average_entropy) return sums.voxels > 0.0 ? sums.sum / sums.voxels : 0.0;
  if (metric != area_factor) return sums.sum;
  const double votes = sums.occupied + sums.shadowed + sums.unobserved;
  if (votes == 0.0) return 0.0;
  return reward(sums.occupied / votes, 0.2) + reward(sums.shadowed / votes, 0.8);
}

}  // namespace skycap::tests
