/// Exact neighbour queries of any size over a growing cloud.
///
/// Two structures answer, each where it is the faster (tests/benchmarks/spatial_index_benchmark):
/// a PointGrid for balls of a few cells, and for everything larger or far from the cloud a forest
/// of CGAL kd-trees whose sizes are powers of two (Bentley and Saxe's logarithmic method), so that
/// an insertion never rebuilds the whole. The forest is built when it is first asked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_grid.h"

namespace skycap::geometry {

/// Deterministic: the same insertions give the same answers in the same order. Queries may run in
/// several threads at once, but those that reach for the forest wait for each other.
class SpatialIndex {
 public:
  /// An index that is fastest for queries of radius up to `typical_radius`.
  explicit SpatialIndex(double typical_radius);
  SpatialIndex(const SpatialIndex&) = delete;
  SpatialIndex& operator=(const SpatialIndex&) = delete;
  ~SpatialIndex();

  std::size_t size() const { return grid_.size(); }
  Eigen::Vector3f point(std::uint32_t index) const { return grid_.point(index); }
  const PointGrid& grid() const { return grid_; }
  PointGrid& grid() { return grid_; }

  /// Adds a point; returns its index, the number of points before it. Points must be finite.
  std::uint32_t insert(const Eigen::Vector3f& point);

  bool any_within(const Eigen::Vector3f& query, double radius) const;
  /// The number of points within `radius`.
  std::size_t count_within(const Eigen::Vector3f& query, double radius) const;
  /// The points within `radius`, ascending by index.
  std::vector<std::uint32_t> within(const Eigen::Vector3f& query, double radius) const;
  /// The `count` nearest points, nearest first, equally near ones by index; all if there are fewer.
  std::vector<Neighbour> nearest(const Eigen::Vector3f& query, std::size_t count) const;

 private:
  struct Forest;
  bool suits_grid(double radius) const;

  PointGrid grid_;
  std::unique_ptr<Forest> forest_;
};

}  // namespace skycap::geometry
