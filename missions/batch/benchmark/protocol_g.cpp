#include "missions/batch/benchmark/protocol_g.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/points/spatial_index.h"

namespace skycap::missions::batch {
namespace {

using Eigen::Vector3f;

constexpr int cells_per_edge = 20;
constexpr double rounding = 0.01;  // [m]

/// Returns the points at the centres of the occupied voxels of 1 cm, sorted.
std::vector<Vector3f> round_points(std::span<const Vector3f> points) {
  std::vector<std::array<std::int64_t, 3>> voxels;
  voxels.reserve(points.size());
  for (const Vector3f& point : points) {
    std::array<std::int64_t, 3> voxel{};
    for (int axis = 0; axis < 3; ++axis) {
      voxel[static_cast<std::size_t>(axis)] =
          std::llround(static_cast<double>(point[axis]) / rounding);
    }
    voxels.push_back(voxel);
  }
  std::ranges::sort(voxels);
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  std::vector<Vector3f> rounded;
  rounded.reserve(voxels.size());
  for (const auto& voxel : voxels) {
    rounded.emplace_back(static_cast<float>(rounding * static_cast<double>(voxel[0])),
                         static_cast<float>(rounding * static_cast<double>(voxel[1])),
                         static_cast<float>(rounding * static_cast<double>(voxel[2])));
  }
  return rounded;
}

double mean_distance(const std::vector<Vector3f>& from, const std::vector<Vector3f>& to) {
  geometry::SpatialIndex index(2.0 * rounding);
  for (const Vector3f& point : to) index.insert(point);
  double sum = 0.0;
  for (const Vector3f& point : from) {
    const Vector3f nearest = index.point(index.nearest(point, 1).front().index);
    sum += static_cast<double>((nearest - point).norm());
  }
  return sum / static_cast<double>(from.size());
}

}  // namespace

double compute_auc(std::span<const double> coverage_after, std::size_t views) {
  double sum = 0.0;
  for (std::size_t view = 0; view < views; ++view) {
    sum += coverage_after[std::min(view, coverage_after.size() - 1)];
  }
  return sum / static_cast<double>(views);
}

GridCoverage compute_grid_coverage(std::span<const Vector3f> cloud,
                                   std::span<const Vector3f> samples,
                                   std::span<const std::uint8_t> is_visible) {
  Eigen::AlignedBox3f box;
  for (const Vector3f& sample : samples) box.extend(sample);
  constexpr std::size_t edge = cells_per_edge;
  std::vector<std::uint8_t> has_sample(edge * edge * edge, 0), has_visible = has_sample,
                                                               has_point = has_sample;
  const auto cell = [&](const Vector3f& point) {
    std::size_t index = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const float size = std::max(box.sizes()[axis], 1e-6F);
      const float share = (point[axis] - box.min()[axis]) / size;
      const int at = static_cast<int>(std::floor(share * cells_per_edge));
      index = edge * index + static_cast<std::size_t>(std::clamp(at, 0, cells_per_edge - 1));
    }
    return index;
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    has_sample[cell(samples[i])] = 1;
    if (is_visible[i] != 0) has_visible[cell(samples[i])] = 1;
  }
  for (const Vector3f& point : cloud) {
    if (box.contains(point)) has_point[cell(point)] = 1;
  }
  const auto covered = [&](const std::vector<std::uint8_t>& counted) {
    std::size_t all = 0, found = 0;
    for (std::size_t i = 0; i < counted.size(); ++i) {
      all += counted[i];
      found += counted[i] & has_point[i];
    }
    return all > 0 ? static_cast<double>(found) / static_cast<double>(all) : 0.0;
  };
  return {covered(has_sample), covered(has_visible)};
}

double compute_chamfer_distance(std::span<const Vector3f> cloud,
                                std::span<const Vector3f> samples) {
  if (cloud.empty() || samples.empty()) return 0.0;
  const std::vector<Vector3f> measured = round_points(cloud), truth = round_points(samples);
  return 0.5 * (mean_distance(measured, truth) + mean_distance(truth, measured));
}

}  // namespace skycap::missions::batch
