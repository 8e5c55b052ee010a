#include "geometry/points/point_grid.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

namespace skycap::geometry {
namespace {

bool has(const auto& cells, std::size_t bit) { return (cells[bit >> 6] >> (bit & 63)) & 1; }
void add(auto& cells, std::size_t bit) { cells[bit >> 6] |= std::uint64_t{1} << (bit & 63); }

}  // namespace

PointGrid::PointGrid(double cell_size)
    : cell_size_(cell_size), inverse_cell_size_(static_cast<float>(1.0 / cell_size)) {
  assert(cell_size > 0.0);
}

inline PointGrid::Cell PointGrid::cell_at(const Eigen::Vector3f& point) const {
  // Clamps the indices, so that arbitrarily large coordinates have a cell. Clamped cells only
  // contain more points.
  constexpr float limit = (1 << 20) - 64;
  const auto along = [&](float coordinate) {
    const float scaled = std::clamp(coordinate * inverse_cell_size_, -limit, limit);
    const auto truncated = static_cast<std::int32_t>(scaled);
    return truncated - (static_cast<float>(truncated) > scaled ? 1 : 0);
  };
  return {along(point.x()), along(point.y()), along(point.z())};
}

inline PointGrid::Key PointGrid::brick_key(const Cell& cell) {
  constexpr std::int32_t offset = 1 << 20;
  const auto part = [](std::int32_t coordinate) {
    return static_cast<Key>(static_cast<std::uint32_t>((coordinate + offset) >> brick_shift));
  };
  return part(cell[0]) << 42 | part(cell[1]) << 21 | part(cell[2]);
}

std::size_t PointGrid::word_index(std::int32_t x) {
  return static_cast<std::size_t>(x & (brick_width - 1));
}

inline std::size_t PointGrid::index_in_brick(const Cell& cell) {
  constexpr std::int32_t mask = brick_width - 1;
  return static_cast<std::size_t>((cell[0] & mask) << (2 * brick_shift) |
                                  (cell[1] & mask) << brick_shift | (cell[2] & mask));
}

std::uint32_t PointGrid::find_or_add_brick(const Cell& cell) {
  const auto next = static_cast<std::uint32_t>(bricks_.size());
  const auto [index, is_new] = brick_indices_.insert(brick_key(cell), next);
  if (is_new) bricks_.emplace_back();
  return index;
}

inline const PointGrid::Brick* PointGrid::find_brick(const Cell& cell) const {
  const std::uint32_t* const index = brick_indices_.find(brick_key(cell));
  return index == nullptr ? nullptr : &bricks_[*index];
}

void PointGrid::start_batch_in(Brick& brick) const {
  if (brick.batch == batch_) return;
  brick.batch = batch_;
  brick.near_new = {};
  brick.new_points = {};
}

// Divides a box of cells among the bricks that it intersects. Calls `visit` for each brick with one
// of its cells, the first and last x, and the bit pattern of the box in each CellSet word. Stops
// and returns true when `visit` returns true.
template <typename Visit>
bool PointGrid::visit_bricks(const Cell& min_cell, const Cell& max_cell, Visit visit) {
  const auto end_in_brick = [](std::int32_t from, std::int32_t last) {
    return std::min(last, from | (brick_width - 1));
  };
  for (std::int32_t x = min_cell[0], x_end; x <= max_cell[0]; x = x_end + 1) {
    x_end = end_in_brick(x, max_cell[0]);
    for (std::int32_t y = min_cell[1], y_end; y <= max_cell[1]; y = y_end + 1) {
      y_end = end_in_brick(y, max_cell[1]);
      for (std::int32_t z = min_cell[2], z_end; z <= max_cell[2]; z = z_end + 1) {
        z_end = end_in_brick(z, max_cell[2]);
        const std::uint64_t row = ((2U << (z_end - z)) - 1U) << (z & (brick_width - 1));
        std::uint64_t pattern = 0;
        for (std::int32_t i = y; i <= y_end; ++i) {
          pattern |= row << ((i & (brick_width - 1)) << brick_shift);
        }
        if (visit(Cell{x, y, z}, x, x_end, pattern)) return true;
      }
    }
  }
  return false;
}

void PointGrid::mark_surroundings(const Cell& cell) {
  const Cell min_cell = {cell[0] - 1, cell[1] - 1, cell[2] - 1};
  const Cell max_cell = {cell[0] + 1, cell[1] + 1, cell[2] + 1};
  visit_bricks(min_cell, max_cell,
               [&](const Cell& corner, std::int32_t x, std::int32_t x_end, std::uint64_t pattern) {
                 Brick& brick = bricks_[find_or_add_brick(corner)];
                 start_batch_in(brick);
                 for (; x <= x_end; ++x) {
                   brick.near_occupied[word_index(x)] |= pattern;
                   brick.near_new[word_index(x)] |= pattern;
                 }
                 return false;
               });
}

void PointGrid::insert(const Eigen::Vector3f& point) {
  const Cell cell = cell_at(point);
  const std::size_t bit = index_in_brick(cell);
  const std::uint32_t index = find_or_add_brick(cell);
  start_batch_in(bricks_[index]);
  if (!has(bricks_[index].new_points, bit)) {
    add(bricks_[index].new_points, bit);
    mark_surroundings(cell);
  }

  Brick& brick = bricks_[index];
  if (brick.heads == none) {
    brick.heads = static_cast<std::uint32_t>(heads_.size());
    heads_.resize(heads_.size() + cells_in_brick, none);
  }
  add(brick.occupied, bit);
  std::uint32_t& head = heads_[brick.heads + bit];
  nodes_.push_back({point.x(), point.y(), point.z(), head});
  head = static_cast<std::uint32_t>(nodes_.size() - 1);
}

bool PointGrid::is_near_batch(const Eigen::Vector3f& point) const {
  const Cell cell = cell_at(point);
  const Brick* brick = find_brick(cell);
  return brick != nullptr && brick->batch == batch_ && has(brick->near_new, index_in_brick(cell));
}

// Calls `visit` with the squared distance and index of each point within `radius` until it returns
// true. Starts with the cell of the query, which usually decides. The other cells include a margin
// for the rounding of cell bounds.
template <typename Visit>
void PointGrid::visit_near(const Eigen::Vector3f& query, double radius, Visit visit) const {
  const auto squared_radius = static_cast<float>(radius * radius);
  const auto visit_cell = [&](std::uint32_t index) {
    while (index != none) {
      const Node& node = nodes_[index];
      const float distance = squared_distance(query, {node.x, node.y, node.z});
      if (distance <= squared_radius && visit(distance, index)) return true;
      index = node.next;
    }
    return false;
  };

  const Cell own = cell_at(query);
  const std::size_t own_index = index_in_brick(own);
  const Brick* own_brick = find_brick(own);
  if (own_brick == nullptr || !has(own_brick->near_occupied, own_index)) {
    if (radius <= cell_size_) return;
  } else if (has(own_brick->occupied, own_index)) {
    if (visit_cell(heads_[own_brick->heads + own_index])) return;
  }

  const Eigen::Vector3f reach =
      static_cast<float>(radius + 1e-5 * (radius + cell_size_)) * Eigen::Vector3f::Ones() +
      1e-6F * query.cwiseAbs();
  visit_bricks(
      cell_at(query - reach), cell_at(query + reach),
      [&](const Cell& corner, std::int32_t x, std::int32_t x_end, std::uint64_t pattern) {
        const bool is_own =
            ((corner[0] ^ own[0]) | (corner[1] ^ own[1]) | (corner[2] ^ own[2])) >> brick_shift ==
            0;
        const Brick* brick = is_own ? own_brick : find_brick(corner);
        if (brick == nullptr || brick->heads == none) return false;
        for (; x <= x_end; ++x) {
          std::uint64_t cells = brick->occupied[word_index(x)] & pattern;
          if (x == own[0] && is_own) cells &= ~(std::uint64_t{1} << (own_index & 63U));
          for (; cells != 0; cells &= cells - 1) {
            const auto bit = 64 * word_index(x) + static_cast<std::size_t>(std::countr_zero(cells));
            if (visit_cell(heads_[brick->heads + bit])) return true;
          }
        }
        return false;
      });
}

std::uint32_t PointGrid::first_within(const Eigen::Vector3f& query, double radius) const {
  std::uint32_t found = none;
  visit_near(query, radius, [&](float, std::uint32_t index) {
    found = index;
    return true;
  });
  return found;
}

std::size_t PointGrid::count_within(const Eigen::Vector3f& query, double radius,
                                    std::size_t limit) const {
  std::size_t count = 0;
  visit_near(query, radius, [&](float, std::uint32_t) { return ++count >= limit; });
  return count;
}

// Calls `visit` for all points within a ball of any size.
template <typename Visit>
void PointGrid::visit_within(const Eigen::Vector3f& query, double radius, Visit visit) const {
  const double bricks_across = 2.0 * radius / (brick_width * cell_size_) + 1.0;
  if (bricks_across * bricks_across * bricks_across <= static_cast<double>(bricks_.size() + 8)) {
    visit_near(query, radius, [&](float distance, std::uint32_t index) {
      visit(distance, index);
      return false;
    });
    return;
  }
  // The ball is larger than the bricks of the cloud, so comparing all points is faster.
  const auto squared_radius = static_cast<float>(radius * radius);
  for (std::uint32_t index = 0; index < nodes_.size(); ++index) {
    const float distance = squared_distance(query, point(index));
    if (distance <= squared_radius) visit(distance, index);
  }
}

void PointGrid::find_within(const Eigen::Vector3f& query, double radius,
                            std::vector<Neighbour>& found) const {
  visit_within(query, radius, [&](float distance, std::uint32_t index) {
    found.push_back({distance, index});
  });
}

void PointGrid::find_points_within(const Eigen::Vector3f& query, double radius,
                                   std::vector<Eigen::Vector3f>& found) const {
  visit_within(query, radius, [&](float, std::uint32_t index) { found.push_back(point(index)); });
}

double PointGrid::empty_length(const Eigen::Vector3f& origin,
                               const Eigen::Vector3f& direction) const {
  const Cell cell = cell_at(origin);
  if (find_brick(cell) != nullptr) return 0.0;
  // The brick and its neighbours are empty, so the ray is free up to the far side of the brick.
  const double width = cell_size_ * brick_width;
  double length = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double slope = direction[static_cast<Eigen::Index>(axis)];
    if (slope == 0.0) continue;
    const std::int32_t brick = cell[axis] >> brick_shift;
    const double side = width * (brick + (slope > 0.0 ? 1 : 0));
    length = std::min(length, (side - origin[static_cast<Eigen::Index>(axis)]) / slope);
  }
  return std::isfinite(length) ? std::max(0.0, length) : 0.0;
}

}  // namespace skycap::geometry
