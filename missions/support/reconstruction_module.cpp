// Module that links PCL, whose libraries take 0.1 s to load. Loaded by reconstruction.cpp.
#include <algorithm>
#include <cmath>
#include <queue>
#include <string>
#include <utility>

#include <Eigen/Eigenvalues>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "missions/support/reconstruction.h"

namespace skycap::missions::support {
namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;
using KdTree = pcl::KdTreeFLANN<pcl::PointNormal>;

Cloud::Ptr pcl_cloud(std::span<const Eigen::Vector3f> points,
                     std::span<const Eigen::Vector3f> normals) {
  auto cloud = pcl::make_shared<Cloud>();
  cloud->reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f normal = normals.empty() ? Eigen::Vector3f::Zero() : normals[i];
    cloud->emplace_back(points[i].x(), points[i].y(), points[i].z(), normal.x(), normal.y(),
                        normal.z());
  }
  return cloud;
}

/// Throws if all points are collinear or equal within the precision of their coordinates. They have
/// no normals, and PCL would process noise.
void require_spread(const Cloud& cloud) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const pcl::PointNormal& point : cloud) mean += point.getVector3fMap().cast<double>();
  mean /= static_cast<double>(cloud.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const pcl::PointNormal& point : cloud) {
    const Eigen::Vector3d offset = point.getVector3fMap().cast<double>() - mean;
    covariance += offset * offset.transpose();
  }
  constexpr double rounding = 1e-6;  // relative precision of single-precision lengths
  const Eigen::Vector3d spread = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance)
                                     .eigenvalues()
                                     .cwiseMax(0.0)
                                     .cwiseSqrt();
  if (spread[1] > rounding * std::max(spread[2], mean.norm())) return;
  throw Error(ErrorKind::bad_geometry,
              "all points are on one line; a surface requires points in a plane or in space");
}

Cloud::Ptr downsampled(const Cloud::Ptr& cloud, double spacing) {
  pcl::VoxelGrid<pcl::PointNormal> grid;
  const auto side = static_cast<float>(spacing);
  grid.setLeafSize(side, side, side);
  grid.setInputCloud(cloud);
  auto result = pcl::make_shared<Cloud>();
  grid.filter(*result);
  for (pcl::PointNormal& point : *result) point.getNormalVector3fMap().normalize();
  return result;
}

void estimate_normals(const Cloud::Ptr& cloud, const ReconstructionConfig& config) {
  pcl::NormalEstimationOMP<pcl::PointNormal, pcl::PointNormal> estimation;
  estimation.setNumberOfThreads(geometry::thread_count(config.threads));
  estimation.setInputCloud(cloud);
  estimation.setKSearch(static_cast<int>(config.neighbours));
  Cloud normals;
  estimation.compute(normals);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    (*cloud)[i].getNormalVector3fMap() = normals[i].getNormalVector3fMap();
  }
}

/// Orients normals consistently along a spanning tree of the nearest-neighbour graph. The tree
/// prefers neighbours with nearly parallel normals (Hoppe et al. 1992, section 3.3). Each connected
/// component starts at its highest point, whose normal points up.
void orient_normals(Cloud& cloud, const KdTree& tree, std::size_t neighbours) {
  struct Step {
    float bend;  // 1 - |cosine| of the angle between the normals
    int from, to;
  };
  const auto is_later = [](const Step& a, const Step& b) { return a.bend > b.bend; };
  std::priority_queue<Step, std::vector<Step>, decltype(is_later)> steps(is_later);
  std::vector<std::uint8_t> is_oriented(cloud.size(), 0);
  std::vector<int> nearest;
  std::vector<float> squares;
  const auto normal = [&](int point) { return cloud[point].getNormalVector3fMap(); };
  const auto settle = [&](int point) {
    is_oriented[point] = 1;
    tree.nearestKSearch(cloud[point], static_cast<int>(neighbours), nearest, squares);
    for (const int other : nearest) {
      if (is_oriented[other] != 0) continue;
      steps.push({1.0F - std::abs(normal(point).dot(normal(other))), point, other});
    }
  };

  std::vector<int> by_height(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) by_height[i] = static_cast<int>(i);
  std::ranges::stable_sort(by_height, [&](int a, int b) { return cloud[a].z > cloud[b].z; });
  for (const int top_point : by_height) {
    if (is_oriented[top_point] != 0) continue;
    if (normal(top_point).z() < 0.0F) normal(top_point) *= -1.0F;
    settle(top_point);
    while (!steps.empty()) {
      const Step step = steps.top();
      steps.pop();
      if (is_oriented[step.to] != 0) continue;
      if (normal(step.from).dot(normal(step.to)) < 0.0F) normal(step.to) *= -1.0F;
      settle(step.to);
    }
  }
}

/// Returns the median nearest-neighbour distance of a few thousand points distributed over the
/// cloud.
double median_spacing(const Cloud& cloud, const KdTree& tree) {
  const std::size_t stride = 1 + cloud.size() / 5000;
  std::vector<float> distances;
  std::vector<int> nearest;
  std::vector<float> squares;
  for (std::size_t i = 0; i < cloud.size(); i += stride) {
    tree.nearestKSearch(cloud[i], 2, nearest, squares);
    distances.push_back(std::sqrt(squares.back()));
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

int octree_depth(const Cloud& cloud, double spacing, const ReconstructionConfig& config) {
  if (config.depth > 0) return config.depth;
  Eigen::AlignedBox3f box;
  for (const pcl::PointNormal& point : cloud) box.extend(point.getVector3fMap());
  const double side = static_cast<double>(box.sizes().maxCoeff());
  const double cells = side / std::max(2.0 * spacing, 1e-9);
  return std::clamp(static_cast<int>(std::ceil(std::log2(std::max(1.0, cells)))), 5, 10);
}

/// Returns the number of cloud points within `radius` of each of `positions`.
std::vector<std::uint32_t> points_around(const Cloud& positions, const KdTree& tree, double radius,
                                         unsigned threads) {
  std::vector<std::uint32_t> counts(positions.size());
  constexpr std::size_t batch = 1024;
  geometry::parallel_for((positions.size() + batch - 1) / batch, threads, [&](std::size_t part) {
    std::vector<int> found;
    std::vector<float> squares;
    const std::size_t end = std::min(positions.size(), (part + 1) * batch);
    for (std::size_t i = part * batch; i < end; ++i) {
      counts[i] =
          static_cast<std::uint32_t>(tree.radiusSearch(positions[i], radius, found, squares));
    }
  });
  return counts;
}

/// Returns the triangles whose corners all have at least `min` cloud points around them.
geometry::Mesh dense_part(const Cloud& vertices, const std::vector<pcl::Vertices>& triangles,
                          const std::vector<std::uint32_t>& around, double min) {
  geometry::Mesh mesh;
  std::vector<std::int64_t> kept(vertices.size(), -1);
  for (const pcl::Vertices& triangle : triangles) {
    const auto& corners = triangle.vertices;
    if (corners.size() != 3 ||
        std::ranges::any_of(corners, [&](auto corner) { return around[corner] < min; })) {
      continue;
    }
    std::array<std::uint32_t, 3> indices{};
    for (int i = 0; i < 3; ++i) {
      std::int64_t& index = kept[corners[i]];
      if (index < 0) {
        index = static_cast<std::int64_t>(mesh.vertices.size());
        mesh.vertices.push_back(vertices[corners[i]].getVector3fMap().cast<double>());
      }
      indices[i] = static_cast<std::uint32_t>(index);
    }
    mesh.triangles.push_back(indices);
  }
  return mesh;
}

Reconstruction reconstructed(std::span<const Eigen::Vector3f> points,
                             std::span<const Eigen::Vector3f> normals,
                             const ReconstructionConfig& config) {
  Cloud::Ptr cloud = pcl_cloud(points, normals);
  if (config.spacing > 0.0) cloud = downsampled(cloud, config.spacing);
  if (cloud->size() < 100) {
    throw Error(ErrorKind::bad_geometry, "too few points: " + std::to_string(cloud->size()) +
                                             "; a surface requires at least 100");
  }
  require_spread(*cloud);
  KdTree tree;
  tree.setInputCloud(cloud);
  if (normals.empty()) {
    estimate_normals(cloud, config);
    orient_normals(*cloud, tree, std::min<std::size_t>(config.neighbours, 10));
  }

  Reconstruction result;
  result.points = cloud->size();
  result.spacing = median_spacing(*cloud, tree);
  result.depth = octree_depth(*cloud, result.spacing, config);
  pcl::Poisson<pcl::PointNormal> poisson;
  poisson.setDepth(result.depth);
  poisson.setThreads(1);  // with several threads, PCL's result is not deterministic
  poisson.setInputCloud(cloud);
  Cloud vertices;
  std::vector<pcl::Vertices> triangles;
  poisson.reconstruct(vertices, triangles);

  // The radius contains a few dozen points at typical density.
  const double radius = 3.0 * std::max(result.spacing, 1e-9);
  std::vector<std::uint32_t> usual = points_around(*cloud, tree, radius, config.threads);
  const auto middle = usual.begin() + static_cast<std::ptrdiff_t>(usual.size() / 2);
  std::nth_element(usual.begin(), middle, usual.end());
  const double min = std::max(config.min_density > 0.0 ? 1.0 : 0.0,
                              config.min_density * static_cast<double>(*middle));
  result.mesh =
      dense_part(vertices, triangles, points_around(vertices, tree, radius, config.threads), min);
  result.trimmed_triangles = triangles.size() - result.mesh.triangles.size();
  if (result.mesh.triangles.empty()) {
    throw Error(ErrorKind::bad_geometry,
                "no part of the surface has the required point density; lower the minimum density");
  }
  return result;
}

}  // namespace
}  // namespace skycap::missions::support

extern "C" [[gnu::visibility("default")]] void skycap_reconstruct(
    std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
    const skycap::missions::support::ReconstructionConfig& config,
    skycap::missions::support::Reconstruction& result) {
  result = skycap::missions::support::reconstructed(points, normals, config);
}
