#include "missions/report/cloud_code.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "missions/report/script_text.h"

namespace skycap::missions::report {
namespace {

constexpr int most_bits = 16;

/// A point by its key.
struct Entry {
  std::uint64_t key = 0;
  std::uint32_t index = 0;
};

/// The bits of a 16-bit number, each third one: abc becomes a00b00c.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1f00000000ffffU;
  bits = (bits | bits << 16) & 0x1f0000ff0000ffU;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fU;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3U;
  return (bits | bits << 2) & 0x1249249249249249U;
}

/// Cubic cells over all points.
struct Grid {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double step = 1.0;

  std::uint64_t key(const Eigen::Vector3f& point) const {
    constexpr double last = (1 << most_bits) - 1;
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::floor((static_cast<double>(point[axis]) - origin[axis]) / step);
      key |= spread(static_cast<std::uint64_t>(std::clamp(cell, 0.0, last))) << axis;
    }
    return key;
  }
};

Grid grid_over(std::span<const Eigen::Vector3f> positions) {
  if (positions.empty()) return {};
  Eigen::Vector3f low = positions[0], high = low;
  for (const Eigen::Vector3f& point : positions) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const double side = (high - low).cast<double>().maxCoeff();
  constexpr double room = 1.0 + 1e-9;  // the farthest point belongs to the last cell
  return {low.cast<double>(), side > 0.0 ? side * room / (1 << most_bits) : 1.0};
}

std::vector<Entry> sorted_entries(std::span<const Eigen::Vector3f> positions, const Grid& grid) {
  std::vector<Entry> entries(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    entries[i] = {grid.key(positions[i]), static_cast<std::uint32_t>(i)};
  }
  // By the bits of the keys, twelve at a time, stable.
  constexpr int digit_bits = 12;
  constexpr std::size_t digits = std::size_t{1} << digit_bits;
  std::vector<Entry> other(entries.size());
  for (int shift = 0; shift < 3 * most_bits; shift += digit_bits) {
    std::array<std::size_t, digits> begin{};
    for (const Entry& entry : entries) ++begin[entry.key >> shift & (digits - 1)];
    std::size_t sum = 0;
    for (std::size_t& count : begin) sum += std::exchange(count, sum);
    for (const Entry& entry : entries) other[begin[entry.key >> shift & (digits - 1)]++] = entry;
    entries.swap(other);
  }
  return entries;
}

/// Evenly along the list.
void thin(std::vector<Entry>& entries, std::size_t most) {
  if (entries.size() <= most) return;
  for (std::size_t i = 0; i < most; ++i)
    entries[i] = entries[(2 * i + 1) * entries.size() / (2 * most)];
  entries.resize(most);
}

std::string planes_of(std::span<const std::uint64_t> values, int planes) {
  std::string bytes;
  bytes.reserve(values.size() * static_cast<std::size_t>(planes));
  for (int plane = 0; plane < planes; ++plane) {
    for (const std::uint64_t value : values) {
      bytes += static_cast<char>(value >> (8 * plane) & 0xff);
    }
  }
  return bytes;
}

/// Each key less the one before it.
std::vector<std::uint64_t> differences(std::span<const std::uint64_t> keys) {
  std::vector<std::uint64_t> steps(keys.begin(), keys.end());
  for (std::size_t i = keys.size(); i-- > 1;) steps[i] -= keys[i - 1];
  return steps;
}

/// How many bits it takes that a cell is at most an eighth as wide as the points are apart.
int bits_for(double spacing_in_cells) {
  int bits = most_bits;
  for (double cell = 2.0; bits > 1 && cell <= spacing_in_cells / 8.0; cell *= 2.0) --bits;
  return bits;
}

}  // namespace

double spacing_of_keys(std::span<const std::uint64_t> keys, int bits) {
  // A neighbour whose key differs in bit b (from 0) is in another cell of all sizes up to 2^(b /
  // 3).
  std::vector<std::size_t> cells(static_cast<std::size_t>(bits) + 1, 1);  // occupied, by size
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const std::uint64_t change = keys[i] ^ keys[i - 1];
    if (change == 0) continue;
    const int level = (static_cast<int>(std::bit_width(change)) - 1) / 3;
    for (int size = 0; size <= std::min(level, bits); ++size)
      ++cells[static_cast<std::size_t>(size)];
  }
  const double wanted = static_cast<double>(keys.size()) / 2.0;
  for (std::size_t size = 0; size < cells.size(); ++size) {
    const auto here = static_cast<double>(cells[size]);
    if (here > wanted) continue;
    if (size == 0) return 1.0;
    const auto finer = static_cast<double>(cells[size - 1]);
    const double part = std::log(wanted / here) / std::log(finer / here);
    return std::exp2(static_cast<double>(size) - part) / std::numbers::sqrt2;
  }
  return std::exp2(bits);
}

CloudCode encode_cloud(std::span<const Eigen::Vector3f> positions,
                       std::span<const CloudAttribute> attributes, std::size_t most_points) {
  const Grid grid = grid_over(positions);
  std::vector<Entry> entries = sorted_entries(positions, grid);
  thin(entries, most_points);
  std::vector<std::uint64_t> keys;
  keys.reserve(entries.size());
  for (const Entry& entry : entries) keys.push_back(entry.key);

  CloudCode code{.points = entries.size(), .of = positions.size(), .origin = grid.origin};
  const double spacing = spacing_of_keys(keys, most_bits);
  code.spacing = entries.size() > 1 ? spacing * grid.step : 0.0;
  code.bits = keys.empty() || keys.front() == keys.back() ? most_bits : bits_for(spacing);
  code.step = std::ldexp(grid.step, most_bits - code.bits);
  for (std::uint64_t& key : keys) key >>= 3 * (most_bits - code.bits);
  std::string bytes = planes_of(differences(keys), (3 * code.bits + 7) / 8);
  for (const CloudAttribute& attribute : attributes) {
    std::vector<std::uint64_t> values;
    values.reserve(entries.size());
    for (const Entry& entry : entries) values.push_back(attribute.values[entry.index]);
    const bool is_small =
        std::ranges::all_of(values, [](std::uint64_t value) { return value < 256; });
    code.attributes.push_back({attribute.name, is_small ? 1 : 2});
    bytes += planes_of(values, code.attributes.back().bytes);
  }
  code.bytes = deflated(bytes);
  return code;
}

}  // namespace skycap::missions::report
