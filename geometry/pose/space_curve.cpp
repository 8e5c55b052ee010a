#include "geometry/pose/space_curve.h"

#include <algorithm>
#include <array>
#include <utility>

namespace skycap::geometry {
namespace {

/// Spreads the bits of a 16-bit number to every third bit: abc becomes a00b00c.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1f00000000ffffU;
  bits = (bits | bits << 16) & 0x1f0000ff0000ffU;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fU;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3U;
  return (bits | bits << 2) & 0x1249249249249249U;
}

}  // namespace

std::uint64_t CurveGrid::key(const Eigen::Vector3f& point) const {
  constexpr double last = (1 << max_bits) - 1;
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = (static_cast<double>(point[axis]) - origin[axis]) / step;
    key |= spread(static_cast<std::uint32_t>(std::min(std::max(0.0, cell), last))) << axis;
  }
  return key;
}

CurveGrid finest_grid(std::span<const Eigen::Vector3f> points) {
  if (points.empty()) return {};
  Eigen::Vector3f low = points[0], high = low;
  for (const Eigen::Vector3f& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const double side = (high - low).cast<double>().maxCoeff();
  constexpr double slack = 1.0 + 1e-9;  // keeps the farthest point in the last cell
  return {low.cast<double>(), side > 0.0 ? side * slack / (1 << CurveGrid::max_bits) : 1.0};
}

void sort_along_curve(std::vector<CurveEntry>& entries, std::span<const Eigen::Vector3f> points,
                      const CurveGrid& grid) {
  // Stable radix sort of the keys with twelve bits per pass.
  constexpr int digit_bits = 12, max_passes = 3 * CurveGrid::max_bits / digit_bits;
  constexpr std::size_t digits = std::size_t{1} << digit_bits;
  std::array<std::array<std::uint32_t, digits>, max_passes> begins{};
  std::uint64_t all = 0;
  for (CurveEntry& entry : entries) {
    entry.key = grid.key(points[entry.index]);
    all |= entry.key;
    for (int pass = 0; pass < max_passes; ++pass) {
      ++begins[static_cast<std::size_t>(pass)][entry.key >> (pass * digit_bits) & (digits - 1)];
    }
  }
  std::vector<CurveEntry> other(entries.size());
  for (int pass = 0; pass < max_passes && all >> (pass * digit_bits) != 0; ++pass) {
    auto& begin = begins[static_cast<std::size_t>(pass)];
    std::uint32_t sum = 0;
    for (std::uint32_t& count : begin) sum += std::exchange(count, sum);
    const int shift = pass * digit_bits;
    for (const CurveEntry& entry : entries)
      other[begin[entry.key >> shift & (digits - 1)]++] = entry;
    entries.swap(other);
  }
}

std::vector<CurveEntry> along_curve(std::span<const Eigen::Vector3f> points,
                                    const CurveGrid& grid) {
  std::vector<CurveEntry> entries(points.size());
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i].index = static_cast<std::uint32_t>(i);
  sort_along_curve(entries, points, grid);
  return entries;
}

}  // namespace skycap::geometry
