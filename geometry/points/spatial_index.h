/// Exact neighbour queries of any size over a growing cloud.
///
/// Combines two structures and uses the faster one for each query
/// (tests/benchmarks/spatial_index_benchmark). A PointGrid answers queries for balls of a few
/// cells. A forest of CGAL kd-trees answers larger queries and queries far from the cloud. The
/// sizes of the trees are powers of two (Bentley and Saxe's logarithmic method), so that an
/// insertion never rebuilds all of them. The forest is built by the first query that needs it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_grid.h"

namespace skycap::geometry {

/// Deterministic: the same insertions give the same results in the same order. Concurrent queries
/// are allowed, but queries of the forest are serialised.
class SpatialIndex {
 public:
  /// Creates an index that is fastest for queries with a radius of up to `typical_radius` [m].
  explicit SpatialIndex(double typical_radius);
  SpatialIndex(const SpatialIndex&) = delete;
  SpatialIndex& operator=(const SpatialIndex&) = delete;
  ~SpatialIndex();

  std::size_t size() const { return grid_.size(); }
  Eigen::Vector3f point(std::uint32_t index) const { return grid_.point(index); }
  const PointGrid& grid() const { return grid_; }
  PointGrid& grid() { return grid_; }

  /// Adds a finite point. Returns its index, which is the number of points before the insertion.
  std::uint32_t insert(const Eigen::Vector3f& point);

  bool any_within(const Eigen::Vector3f& query, double radius) const;
  /// Returns the number of points within `radius`.
  std::size_t count_within(const Eigen::Vector3f& query, double radius) const;
  /// Returns the points within `radius`, ascending by index.
  std::vector<std::uint32_t> within(const Eigen::Vector3f& query, double radius) const;
  /// Returns the `count` nearest points, or all points if there are fewer. They are sorted by
  /// distance, then by index.
  std::vector<Neighbour> nearest(const Eigen::Vector3f& query, std::size_t count) const;

 private:
  struct Forest;
  bool suits_grid(double radius) const;

  PointGrid grid_;
  std::unique_ptr<Forest> forest_;
};

}  // namespace skycap::geometry
