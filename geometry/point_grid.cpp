#include "geometry/point_grid.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace skycap::geometry {
namespace {

constexpr float far_away = 1e18F;  // its square is finite, and no query reaches it
constexpr std::uint64_t no_key = ~std::uint64_t{0};

}  // namespace

PointGrid::KeyMap::KeyMap() : slots_(1024, Slot{no_key, none}) {}

std::size_t PointGrid::KeyMap::slot_of(Key key) const {
  // Fibonacci hashing: the high bits of the product depend on all bits of the key.
  const Key mixed = (key ^ (key >> 32)) * 0x9e3779b97f4a7c15U;
  std::size_t slot = static_cast<std::size_t>(mixed >> 20) & (slots_.size() - 1);
  while (slots_[slot].key != key && slots_[slot].key != no_key) {
    slot = (slot + 1) & (slots_.size() - 1);
  }
  return slot;
}

std::uint32_t PointGrid::KeyMap::find(Key key) const { return slots_[slot_of(key)].value; }

std::uint32_t PointGrid::KeyMap::find_or_add(Key key, std::uint32_t value) {
  std::size_t slot = slot_of(key);
  if (slots_[slot].key == key) return slots_[slot].value;
  if (2 * (used_ + 1) > slots_.size()) {
    grow();
    slot = slot_of(key);
  }
  slots_[slot] = {key, value};
  ++used_;
  return value;
}

void PointGrid::KeyMap::grow() {
  std::vector<Slot> old(4 * slots_.size(), Slot{no_key, none});
  old.swap(slots_);
  for (const Slot& slot : old) {
    if (slot.key != no_key) slots_[slot_of(slot.key)] = slot;
  }
}

PointGrid::PointGrid(double cell_size)
    : cell_size_(cell_size), inverse_cell_size_(static_cast<float>(1.0 / cell_size)) {
  assert(cell_size > 0.0);
}

PointGrid::Cell3 PointGrid::cell_at(const Eigen::Vector3f& point) const {
  // Clamped so that even absurd coordinates have a cell; such cells are merely crowded.
  constexpr float limit = 1 << 20;
  const auto along = [&](float coordinate) {
    const float scaled = std::clamp(coordinate * inverse_cell_size_, -limit + 8, limit - 8);
    const auto truncated = static_cast<std::int32_t>(scaled);
    return truncated - (static_cast<float>(truncated) > scaled ? 1 : 0);
  };
  return {along(point.x()), along(point.y()), along(point.z())};
}

PointGrid::Key PointGrid::key_of(const Cell3& cell) {
  constexpr std::int32_t offset = 1 << 20;
  const auto part = [](std::int32_t coordinate) {
    return static_cast<Key>(static_cast<std::uint32_t>(coordinate + offset));
  };
  return part(cell[0]) << 42 | part(cell[1]) << 21 | part(cell[2]);
}

std::uint32_t PointGrid::cell_index(const Cell3& cell) {
  const auto next = static_cast<std::uint32_t>(cells_.size());
  const std::uint32_t index = index_of_cell_.find_or_add(key_of(cell), next);
  if (index == next) cells_.emplace_back();
  return index;
}

void PointGrid::mark_neighbourhood(const Cell3& cell) {
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dz = -1; dz <= 1; ++dz) {
        const Cell3 near = {cell[0] + dx, cell[1] + dy, cell[2] + dz};
        cells_[cell_index(near)].near_batch = batch_;
        coarse_cells_.find_or_add(
            key_of({near[0] >> coarse_shift, near[1] >> coarse_shift, near[2] >> coarse_shift}), 1);
      }
    }
  }
}

void PointGrid::insert(const Eigen::Vector3f& point) {
  const Cell3 coordinates = cell_at(point);
  if (last_index_ == none || coordinates != last_cell_) {
    last_index_ = cell_index(coordinates);
    last_cell_ = coordinates;
  }
  const std::uint32_t index = last_index_;
  if (cells_[index].own_batch != batch_) {
    cells_[index].own_batch = batch_;
    mark_neighbourhood(coordinates);
  }

  Cell& cell = cells_[index];
  if (cell.in_first_block == block_size) {
    Block block;
    block.x.fill(far_away);
    block.y.fill(far_away);
    block.z.fill(far_away);
    block.index.fill(none);
    block.next = cell.first_block;
    cell.first_block = static_cast<std::uint32_t>(blocks_.size());
    cell.in_first_block = 0;
    blocks_.push_back(block);
  }
  Block& block = blocks_[cell.first_block];
  const std::size_t place = cell.in_first_block++;
  block.x[place] = point.x();
  block.y[place] = point.y();
  block.z[place] = point.z();
  block.index[place] = static_cast<std::uint32_t>(cell_of_point_.size());
  cell_of_point_.push_back(index);
}

std::size_t PointGrid::count_in_cell(std::uint32_t cell, const Eigen::Vector3f& query,
                                     float squared_radius, std::size_t limit) const {
  std::size_t count = 0;
  for (std::uint32_t b = cells_[cell].first_block; b != none; b = blocks_[b].next) {
    const Block& block = blocks_[b];
    std::uint32_t in_block = 0;
    for (std::size_t i = 0; i < block_size; ++i) {
      const float x = query.x() - block.x[i], y = query.y() - block.y[i],
                  z = query.z() - block.z[i];
      in_block += (x * x + y * y + z * z <= squared_radius) ? 1U : 0U;
    }
    count += in_block;
    if (count >= limit) break;
  }
  return count;
}

std::size_t PointGrid::count_within(const Eigen::Vector3f& query, double radius,
                                    std::size_t limit) const {
  assert(radius <= cell_size_ * (1.0 + 1e-6));
  const Cell3 own = cell_at(query);
  const auto squared_radius = static_cast<float>(radius * radius);
  const std::uint32_t own_index =
      (last_index_ != none && own == last_cell_) ? last_index_ : index_of_cell_.find(key_of(own));
  if (own_index == none) return 0;  // every cell beside an occupied one exists
  std::size_t count = count_in_cell(own_index, query, squared_radius, limit);
  if (count >= limit) return count;

  // Only the cells that the ball reaches; a margin covers the rounding of the cell's bounds.
  std::array<int, 3> lowest, highest;
  for (int axis = 0; axis < 3; ++axis) {
    const double inside = query[axis] - own[axis] * cell_size_;
    const double margin = 1e-5 * cell_size_ + 1e-6 * std::abs(static_cast<double>(query[axis]));
    lowest[axis] = inside - radius <= margin ? -1 : 0;
    highest[axis] = inside + radius >= cell_size_ - margin ? 1 : 0;
  }
  for (int dx = lowest[0]; dx <= highest[0]; ++dx) {
    for (int dy = lowest[1]; dy <= highest[1]; ++dy) {
      for (int dz = lowest[2]; dz <= highest[2]; ++dz) {
        if (dx == 0 && dy == 0 && dz == 0) continue;
        const std::uint32_t cell =
            index_of_cell_.find(key_of({own[0] + dx, own[1] + dy, own[2] + dz}));
        if (cell == none) continue;
        count += count_in_cell(cell, query, squared_radius, limit - count);
        if (count >= limit) return count;
      }
    }
  }
  return count;
}

void PointGrid::find_within(const Eigen::Vector3f& query, double radius,
                            std::vector<Neighbour>& found) const {
  const auto squared_radius = static_cast<float>(radius * radius);
  const auto reach =
      static_cast<float>(radius * (1.0 + 1e-5) + 1e-5 * cell_size_) * Eigen::Vector3f::Ones() +
      1e-6F * query.cwiseAbs();
  const Cell3 lowest = cell_at(query - reach), highest = cell_at(query + reach);
  for (std::int32_t x = lowest[0]; x <= highest[0]; ++x) {
    for (std::int32_t y = lowest[1]; y <= highest[1]; ++y) {
      for (std::int32_t z = lowest[2]; z <= highest[2]; ++z) {
        const std::uint32_t cell = index_of_cell_.find(key_of({x, y, z}));
        if (cell == none) continue;
        for (std::uint32_t b = cells_[cell].first_block; b != none; b = blocks_[b].next) {
          const Block& block = blocks_[b];
          for (std::size_t i = 0; i < block_size && block.index[i] != none; ++i) {
            const float distance = squared_distance(query, {block.x[i], block.y[i], block.z[i]});
            if (distance <= squared_radius) found.push_back({distance, block.index[i]});
          }
        }
      }
    }
  }
}

double PointGrid::empty_length(const Eigen::Vector3f& origin,
                               const Eigen::Vector3f& direction) const {
  const Cell3 cell = cell_at(origin);
  const Cell3 coarse = {cell[0] >> coarse_shift, cell[1] >> coarse_shift, cell[2] >> coarse_shift};
  if (coarse_cells_.find(key_of(coarse)) != none) return 0.0;
  // Nothing occupied touches the coarse cell or its rim: free to the coarse cell's far side.
  const double width = cell_size_ * (1 << coarse_shift);
  double length = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0F) continue;
    const double side = width * (coarse[axis] + (direction[axis] > 0.0F ? 1 : 0));
    length = std::min(length, (side - origin[axis]) / direction[axis]);
  }
  return std::isfinite(length) ? std::max(0.0, length) : 0.0;
}

}  // namespace skycap::geometry
