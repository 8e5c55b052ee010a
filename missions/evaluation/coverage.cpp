#include "missions/evaluation/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "geometry/points/point_grid.h"

namespace skycap::missions::evaluation {

CoverageMeter::CoverageMeter(std::span<const Eigen::Vector3f> samples, double registration_distance)
    // A ball of radius r_d then intersects at most two cells per axis. The margin allows for the
    // rounding of coordinates to cells.
    : cell_size_(2.0 * registration_distance * (1.0 + 1e-6)),
      squared_distance_(static_cast<float>(registration_distance * registration_distance)),
      is_covered_(samples.size(), 0),
      ranges_(samples.size()) {
  std::vector<Cell> cells;
  cells.reserve(samples.size());
  for (const Eigen::Vector3f& sample : samples) cells.push_back(sample_cell(sample));
  std::vector<std::uint32_t> order(samples.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return cells[i]; });
  samples_.reserve(samples.size());
  for (const std::uint32_t i : order) {
    const auto sample_index = static_cast<std::uint32_t>(samples_.size());
    ++ranges_.insert(cells[i], {sample_index, sample_index}).value.end;
    samples_.push_back({samples[i], i});
  }
}

CoverageMeter::Cell CoverageMeter::cell_at(std::int64_t x, std::int64_t y, std::int64_t z) {
  // Uses 21 bits per axis. Cells with the same key are searched together, without affecting the
  // result.
  constexpr std::int64_t mask = (1 << 21) - 1;
  return static_cast<Cell>((x & mask) << 42 | (y & mask) << 21 | (z & mask));
}

CoverageMeter::Cell CoverageMeter::sample_cell(const Eigen::Vector3f& sample) const {
  const auto cell = [&](int axis) {
    return static_cast<std::int64_t>(std::floor(double{sample[axis]} / cell_size_));
  };
  return cell_at(cell(0), cell(1), cell(2));
}

void CoverageMeter::add(std::span<const Eigen::Vector3f> points) {
  using Corner = std::array<std::int64_t, 3>;
  std::optional<Corner> latest;  // Consecutive points are usually close to the same corner.
  std::array<Cell, 8> cells{};
  std::size_t count = 0;  // Number of cells around that corner with uncovered samples.
  for (const Eigen::Vector3f& point : points) {
    // The eight cells around the cell corner nearest to the point contain the whole ball.
    const auto corner = [&](int axis) {
      return static_cast<std::int64_t>(std::floor(double{point[axis]} / cell_size_ + 0.5));
    };
    const Corner nearest{corner(0), corner(1), corner(2)};
    if (nearest != latest) {
      latest = nearest;
      count = 0;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const Cell cell = cell_at(nearest[0] - static_cast<std::int64_t>(i >> 2U & 1U),
                                  nearest[1] - static_cast<std::int64_t>(i >> 1U & 1U),
                                  nearest[2] - static_cast<std::int64_t>(i & 1U));
        const Range* const range = ranges_.find(cell);
        if (range != nullptr && range->begin != range->end) cells[count++] = cell;
      }
    }
    for (std::size_t i = 0; i < count; ++i) cover_cell(cells[i], point);
  }
}

void CoverageMeter::cover_cell(Cell cell, const Eigen::Vector3f& point) {
  Range* const range = ranges_.find(cell);
  if (range == nullptr) return;
  for (std::uint32_t i = range->begin; i < range->end;) {
    if (geometry::squared_distance(samples_[i].position, point) > squared_distance_) {
      ++i;
      continue;
    }
    is_covered_[samples_[i].index] = 1;
    ++covered_;
    samples_[i] = samples_[--range->end];
  }
}

double CoverageMeter::share() const {
  if (is_covered_.empty()) return 0.0;
  return static_cast<double>(covered_) / static_cast<double>(is_covered_.size());
}

std::optional<double> covered_share(std::span<const std::uint8_t> is_covered,
                                    std::span<const std::uint8_t> counts) {
  std::size_t marked = 0, covered = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (!counts[i]) continue;
    ++marked;
    covered += is_covered[i];
  }
  if (marked == 0) return std::nullopt;
  return static_cast<double>(covered) / static_cast<double>(marked);
}

double marked_share(std::span<const std::uint8_t> marks) {
  if (marks.empty()) return 0.0;
  const auto marked = marks.size() - static_cast<std::size_t>(std::ranges::count(marks, 0));
  return static_cast<double>(marked) / static_cast<double>(marks.size());
}

std::vector<Eigen::Vector3d> fibonacci_directions(std::size_t count) {
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<Eigen::Vector3d> directions;
  directions.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
    const double radius = std::sqrt(1.0 - z * z);
    const double azimuth = golden_angle * static_cast<double>(i);
    directions.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
  }
  return directions;
}

}  // namespace skycap::missions::evaluation
