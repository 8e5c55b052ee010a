/// Neighbours within a small radius in a growing cloud: the inner loop of every planner.
///
/// A hash grid whose cells are as wide as the largest radius that will be asked for. Inserting a
/// point costs constant time and a query reads at most 27 cells, however large the cloud is. Cells
/// hold their points in short blocks of coordinates, so that a compiler can compare several at
/// once, and the cells around occupied ones are known, so that a query in empty space ends at its
/// first look-up. SpatialIndex adds queries of any size.
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
  /// A grid for queries of radius up to `cell_size`, which must be positive. Coordinates may reach
  /// a million cells from the origin in each direction; farther ones still work, only slower.
  explicit PointGrid(double cell_size);

  std::size_t size() const { return cell_of_point_.size(); }
  double cell_size() const { return cell_size_; }

  /// Adds a point, whose index is the number of points before it. Points must be finite.
  void insert(const Eigen::Vector3f& point);

  /// Starts a new batch of insertions, for is_near_batch().
  void begin_batch() { ++batch_; }
  /// Whether a point was inserted in the current batch in the cell of point `index` or in one
  /// beside it. Where this is false, nothing within cell_size() of the point is new.
  bool is_near_batch(std::uint32_t index) const {
    return cells_[cell_of_point_[index]].near_batch == batch_;
  }

  /// Whether any point is within `radius` (at most cell_size()) of `query`.
  bool any_within(const Eigen::Vector3f& query, double radius) const {
    return count_within(query, radius, 1) != 0;
  }

  /// The number of points within `radius` (at most cell_size()) of `query`; counting stops once
  /// `limit` is reached, and what was counted by then is returned.
  std::size_t count_within(const Eigen::Vector3f& query, double radius, std::size_t limit) const;

  /// Appends to `found` the points within `radius` of `query`, in no particular order. Reads every
  /// cell that the ball touches, so a radius of several cells is slow.
  void find_within(const Eigen::Vector3f& query, double radius,
                   std::vector<Neighbour>& found) const;

  /// A lower bound, zero or more, of the length of the empty piece of the ray from `origin` along
  /// the unit vector `direction`: on it no point is within cell_size() of the ray. Large steps are
  /// certain only in wide empty space; zero says nothing.
  double empty_length(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  static constexpr std::size_t block_size = 8;
  static constexpr int coarse_shift = 3;  // a coarse cell is 8 cells wide

  using Key = std::uint64_t;
  using Cell3 = std::array<std::int32_t, 3>;

  struct Block {
    std::array<float, block_size> x, y, z;  // unused places are far away from everything
    std::array<std::uint32_t, block_size> index;
    std::uint32_t next;
  };
  struct Cell {
    std::uint32_t first_block = none;
    std::uint32_t in_first_block = block_size;
    std::uint32_t near_batch = 0;
    std::uint32_t own_batch = 0;
  };
  /// Open addressing, linear probing, at most half full.
  class KeyMap {
   public:
    KeyMap();
    std::uint32_t find(Key key) const;
    std::uint32_t find_or_add(Key key, std::uint32_t value);  // the value now stored

   private:
    struct Slot {
      Key key;
      std::uint32_t value;
    };
    std::size_t slot_of(Key key) const;
    void grow();
    std::vector<Slot> slots_;
    std::size_t used_ = 0;
  };

  Cell3 cell_at(const Eigen::Vector3f& point) const;
  static Key key_of(const Cell3& cell);
  std::uint32_t cell_index(const Cell3& cell);  // makes the cell if need be
  void mark_neighbourhood(const Cell3& cell);
  std::size_t count_in_cell(std::uint32_t cell, const Eigen::Vector3f& query, float squared_radius,
                            std::size_t limit) const;

  double cell_size_;
  float inverse_cell_size_;
  std::uint32_t batch_ = 1;
  KeyMap index_of_cell_;
  KeyMap coarse_cells_;  // those that hold a cell which is occupied or beside an occupied one
  std::vector<Cell> cells_;
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> cell_of_point_;
  // The last cell inserted into: a scan's points come in runs that share one.
  Cell3 last_cell_{};
  std::uint32_t last_index_ = none;
};

}  // namespace skycap::geometry
