/// Fixed-radius neighbour queries in a growing cloud. This is the inner loop of every planner.
///
/// A sparse grid whose cell size is the largest common query radius. Cells are grouped into bricks
/// of 8 x 8 x 8, which are found by hashing and contiguous in memory. Insertion takes constant
/// time, and a query reads at most 27 cells, independent of the cloud size. Each brick stores which
/// of its cells are occupied or adjacent to an occupied cell, so queries in empty space end early.
/// SpatialIndex adds queries of any radius.
///
/// Distances use single precision, as the points do: p is within r of q if squared_distance(p, q)
/// <= float(r * r). Every query uses this comparison.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/hash_grid.h"

namespace skycap::geometry {

/// Returns (a - b)^2 in single precision, summed in the order x, y, z.
inline float squared_distance(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  const float x = a.x() - b.x(), y = a.y() - b.y(), z = a.z() - b.z();
  return x * x + y * y + z * z;
}

/// Point of the cloud and its squared distance from a query [m^2].
struct Neighbour {
  float squared_distance;
  std::uint32_t index;

  /// Orders by distance, then by index.
  friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
};

class PointGrid {
 public:
  /// Return value of first_within() if no point is found.
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  /// Creates a grid for queries with a radius of up to `cell_size` [m], which must be positive.
  /// Coordinates should be within one million cells of the origin. Larger coordinates are correct
  /// but slower.
  explicit PointGrid(double cell_size);

  std::size_t size() const { return nodes_.size(); }
  double cell_size() const { return cell_size_; }

  Eigen::Vector3f point(std::uint32_t index) const {
    const Node& node = nodes_[index];
    return {node.x, node.y, node.z};
  }

  /// Adds a finite point. Its index is the number of points before the insertion.
  void insert(const Eigen::Vector3f& point);

  /// Starts a new batch of insertions for is_near_batch().
  void begin_batch() { ++batch_; }
  /// Returns whether the current batch has a point in the cell of `point` or in an adjacent cell.
  /// If false, no new point lies within cell_size() of `point`.
  bool is_near_batch(const Eigen::Vector3f& point) const;

  /// Returns the index of a point within `radius` (at most cell_size()) of `query`, or `none`.
  std::uint32_t first_within(const Eigen::Vector3f& query, double radius) const;
  bool any_within(const Eigen::Vector3f& query, double radius) const {
    return first_within(query, radius) != none;
  }
  /// Returns the number of points within `radius` (at most cell_size()) of `query`, but at most
  /// `limit`.
  std::size_t count_within(const Eigen::Vector3f& query, double radius, std::size_t limit) const;

  /// Appends the points within `radius` of `query` to `found`. Their order depends only on the
  /// insertions. Reads all bricks that intersect the ball, or all points if there are fewer.
  void find_within(const Eigen::Vector3f& query, double radius,
                   std::vector<Neighbour>& found) const;

  /// Appends the positions of the points within `radius` of `query` to `found`.
  void find_points_within(const Eigen::Vector3f& query, double radius,
                          std::vector<Eigen::Vector3f>& found) const;

  /// Returns a lower bound (>= 0) of the free length [m] of the ray from `origin` along the unit
  /// vector `direction`. Up to this length, no point lies within cell_size() of the ray. The bound
  /// is large only in wide empty space and may be zero anywhere.
  double empty_length(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;

 private:
  static constexpr int brick_shift = 3;
  static constexpr int brick_width = 1 << brick_shift;  // [cells]
  static constexpr std::size_t cells_in_brick = 512;

  using Cell = std::array<std::int32_t, 3>;
  using Key = std::uint64_t;
  using CellSet = std::array<std::uint64_t, brick_width>;  // one bit per cell, one word per x

  /// Point and the index of the next point in its cell.
  struct Node {
    float x, y, z;
    std::uint32_t next;
  };
  struct Brick {
    CellSet occupied{};       // cells that contain points
    CellSet near_occupied{};  // occupied cells and their neighbours
    CellSet near_new{};       // cells of `new_points` and their neighbours
    CellSet new_points{};     // cells with points of batch `batch`
    std::uint32_t batch = 0;
    std::uint32_t heads = none;  // offset of the first nodes of its cells in heads_
  };
  Cell cell_at(const Eigen::Vector3f& point) const;
  static Key brick_key(const Cell& cell);
  static std::size_t word_index(std::int32_t x);
  static std::size_t index_in_brick(const Cell& cell);
  std::uint32_t find_or_add_brick(const Cell& cell);  // creates the brick if it does not exist
  const Brick* find_brick(const Cell& cell) const;
  void start_batch_in(Brick& brick) const;
  void mark_surroundings(const Cell& cell);
  template <typename Visit>
  static bool visit_bricks(const Cell& min_cell, const Cell& max_cell, Visit visit);
  template <typename Visit>
  void visit_within(const Eigen::Vector3f& query, double radius, Visit visit) const;
  template <typename Visit>
  void visit_near(const Eigen::Vector3f& query, double radius, Visit visit) const;

  double cell_size_;
  float inverse_cell_size_;
  std::uint32_t batch_ = 1;
  HashGrid<std::uint32_t> brick_indices_{128};
  std::vector<Brick> bricks_;
  std::vector<std::uint32_t> heads_;  // cells_in_brick entries for each brick with points
  std::vector<Node> nodes_;           // by point index
};

}  // namespace skycap::geometry
