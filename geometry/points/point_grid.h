/// Neighbours within a small radius in a growing cloud: the inner loop of every planner.
///
/// A sparse grid whose cells are as wide as the largest radius that is usual. Cells come in bricks
/// of 8 x 8 x 8, found by hashing, so that a neighbourhood is looked up once and then read from
/// memory that lies together. Inserting a point costs constant time, and a query reads at most 27
/// cells, however large the cloud is. Bricks also know which of their cells are in or beside an
/// occupied one: a query in empty space ends there. SpatialIndex adds queries of any size.
///
/// Distances are single precision, as the points are: p is within r of q if
/// squared_distance(p, q) <= float(r * r). Every query uses that one comparison.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/hash_grid.h"

namespace skycap::geometry {

/// (a - b)^2 in single precision, the sum taken from x to z.
inline float squared_distance(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  const float x = a.x() - b.x(), y = a.y() - b.y(), z = a.z() - b.z();
  return x * x + y * y + z * z;
}

/// A point of the cloud and its squared distance from a query.
struct Neighbour {
  float squared_distance;
  std::uint32_t index;

  /// Nearer first; of equally near ones, the earlier point.
  friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
};

class PointGrid {
 public:
  /// What first_within() says when there is no such point.
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  /// A grid for queries of radius up to `cell_size`, which must be positive. Coordinates may reach
  /// a million cells from the origin in each direction; farther ones still work, only slower.
  explicit PointGrid(double cell_size);

  std::size_t size() const { return nodes_.size(); }
  double cell_size() const { return cell_size_; }

  Eigen::Vector3f point(std::uint32_t index) const {
    const Node& node = nodes_[index];
    return {node.x, node.y, node.z};
  }

  /// Adds a point, whose index is the number of points before it. Points must be finite.
  void insert(const Eigen::Vector3f& point);

  /// Starts a new batch of insertions, for is_near_batch().
  void begin_batch() { ++batch_; }
  /// Whether a point was inserted in the current batch in the cell that holds `point` or in one
  /// beside it. Where this is false, nothing within cell_size() of `point` is new.
  bool is_near_batch(const Eigen::Vector3f& point) const;

  /// A point within `radius` (at most cell_size()) of `query`, or none.
  std::uint32_t first_within(const Eigen::Vector3f& query, double radius) const;
  bool any_within(const Eigen::Vector3f& query, double radius) const {
    return first_within(query, radius) != none;
  }
  /// The number of points within `radius` (at most cell_size()) of `query`, or `limit` if it is
  /// larger.
  std::size_t count_within(const Eigen::Vector3f& query, double radius, std::size_t limit) const;

  /// Appends to `found` the points within `radius` of `query`, in an order that depends on the
  /// insertions alone. Reads every brick that the ball touches, or every point if those are fewer.
  void find_within(const Eigen::Vector3f& query, double radius,
                   std::vector<Neighbour>& found) const;

  /// The same, the points themselves.
  void find_points_within(const Eigen::Vector3f& query, double radius,
                          std::vector<Eigen::Vector3f>& found) const;

  /// A lower bound, zero or more, of the length of the empty piece of the ray from `origin` along
  /// the unit vector `direction`: on it no point is within cell_size() of the ray. Large steps are
  /// certain only in wide empty space; zero says nothing.
  double empty_length(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;

 private:
  static constexpr int brick_shift = 3;
  static constexpr int brick_width = 1 << brick_shift;  // in cells
  static constexpr std::size_t cells_in_brick = 512;

  using Cell = std::array<std::int32_t, 3>;
  using Key = std::uint64_t;
  using CellSet = std::array<std::uint64_t, brick_width>;  // a bit a cell, a word an x

  /// A point, and the next one in its cell.
  struct Node {
    float x, y, z;
    std::uint32_t next;
  };
  struct Brick {
    CellSet occupied{};       // cells that hold points
    CellSet near_occupied{};  // cells in or beside an occupied one
    CellSet near_new{};       // the same for points of batch `batch`
    CellSet new_points{};     // cells with points of batch `batch`
    std::uint32_t batch = 0;
    std::uint32_t heads = none;  // where the first nodes of its cells stand in heads_
  };
  Cell cell_at(const Eigen::Vector3f& point) const;
  static Key brick_key(const Cell& cell);
  static std::size_t word_of(std::int32_t x);
  static std::size_t place_in_brick(const Cell& cell);
  std::uint32_t brick_of(const Cell& cell);  // made if need be
  const Brick* find_brick(const Cell& cell) const;
  void start_batch_in(Brick& brick) const;
  void mark_surroundings(const Cell& cell);
  template <typename Visit>
  static bool visit_bricks(const Cell& lowest, const Cell& highest, Visit visit);
  template <typename Visit>
  void visit_within(const Eigen::Vector3f& query, double radius, Visit visit) const;
  template <typename Visit>
  void visit_near(const Eigen::Vector3f& query, double radius, Visit visit) const;

  double cell_size_;
  float inverse_cell_size_;
  std::uint32_t batch_ = 1;
  HashGrid<std::uint32_t> index_of_brick_{128};
  std::vector<Brick> bricks_;
  std::vector<std::uint32_t> heads_;  // cells_in_brick for each brick that holds points
  std::vector<Node> nodes_;           // by index of the point
};

}  // namespace skycap::geometry
