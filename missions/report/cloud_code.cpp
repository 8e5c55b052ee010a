#include "missions/report/cloud_code.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
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
      const double cell = (static_cast<double>(point[axis]) - origin[axis]) / step;
      key |= spread(static_cast<std::uint32_t>(std::clamp(cell, 0.0, last))) << axis;
    }
    return key;
  }
};

/// Of 2^16 cells along the longest side.
Grid finest_grid(std::span<const Eigen::Vector3f> positions) {
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

/// Gives the entries their keys in a grid and sorts them, those of a cell as they were.
void sort_by_key(std::vector<Entry>& entries, std::span<const Eigen::Vector3f> positions,
                 const Grid& grid) {
  // By the bits of the keys, twelve at a time, stable.
  constexpr int digit_bits = 12, most_passes = 3 * most_bits / digit_bits;
  constexpr std::size_t digits = std::size_t{1} << digit_bits;
  std::array<std::array<std::uint32_t, digits>, most_passes> begins{};
  std::uint64_t all = 0;
  for (Entry& entry : entries) {
    entry.key = grid.key(positions[entry.index]);
    all |= entry.key;
    for (int pass = 0; pass < most_passes; ++pass) {
      ++begins[static_cast<std::size_t>(pass)][entry.key >> (pass * digit_bits) & (digits - 1)];
    }
  }
  std::vector<Entry> other(entries.size());
  for (int pass = 0; pass < most_passes && all >> (pass * digit_bits) != 0; ++pass) {
    auto& begin = begins[static_cast<std::size_t>(pass)];
    std::uint32_t sum = 0;
    for (std::uint32_t& count : begin) sum += std::exchange(count, sum);
    const int shift = pass * digit_bits;
    for (const Entry& entry : entries) other[begin[entry.key >> shift & (digits - 1)]++] = entry;
    entries.swap(other);
  }
}

std::vector<Entry> sorted_entries(std::span<const Eigen::Vector3f> positions, const Grid& grid) {
  std::vector<Entry> entries(positions.size());
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i].index = static_cast<std::uint32_t>(i);
  sort_by_key(entries, positions, grid);
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
  std::string bytes(values.size() * static_cast<std::size_t>(planes), '\0');
  auto next = bytes.begin();
  for (int plane = 0; plane < planes; ++plane) {
    for (const std::uint64_t value : values) *next++ = static_cast<char>(value >> (8 * plane));
  }
  return bytes;
}

/// Each key less the one before it.
std::vector<std::uint64_t> differences(std::span<const std::uint64_t> keys) {
  std::vector<std::uint64_t> steps(keys.begin(), keys.end());
  for (std::size_t i = keys.size(); i-- > 1;) steps[i] -= keys[i - 1];
  return steps;
}

std::vector<std::uint64_t> keys_of(std::span<const Entry> entries) {
  std::vector<std::uint64_t> keys;
  keys.reserve(entries.size());
  for (const Entry& entry : entries) keys.push_back(entry.key);
  return keys;
}

double spacing_in(const Grid& grid, std::span<const Entry> entries) {
  return entries.size() > 1 ? spacing_of_keys(keys_of(entries), most_bits) * grid.step : 0.0;
}

/// What the places of a cell take: of all cells that have points.
int bits_of(std::span<const std::uint64_t> keys) {
  const int width = keys.empty() ? 0 : static_cast<int>(std::bit_width(keys.back()));
  return std::max(1, (width + 2) / 3);
}

/// The places that the values stand at, each moved to the front of the list when it is met.
std::vector<std::uint64_t> places_in_list(std::span<const std::uint16_t> values,
                                          std::size_t different) {
  std::vector<std::uint16_t> list(different);
  std::iota(list.begin(), list.end(), std::uint16_t{0});
  std::vector<std::uint64_t> places;
  places.reserve(values.size());
  for (const std::uint16_t value : values) {
    const auto found = std::ranges::find(list, value);
    places.push_back(static_cast<std::uint64_t>(found - list.begin()));
    std::rotate(list.begin(), found, found + 1);
  }
  return places;
}

/// The values in the order of `first`, points that are alike there in the order that they have.
std::vector<std::uint16_t> ordered_by(std::span<const std::uint16_t> first,
                                      std::span<const std::uint16_t> values) {
  std::vector<std::size_t> begin(std::size_t{1} << 16, 0);
  for (const std::uint16_t value : first) ++begin[value];
  std::size_t sum = 0;
  for (std::size_t& count : begin) sum += std::exchange(count, sum);
  std::vector<std::uint16_t> ordered(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) ordered[begin[first[i]]++] = values[i];
  return ordered;
}

std::vector<std::uint16_t> values_of(const CloudAttribute& attribute,
                                     std::span<const Entry> entries) {
  std::vector<std::uint16_t> values;
  values.reserve(entries.size());
  for (const Entry& entry : entries) values.push_back(attribute.values[entry.index]);
  return values;
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

double spacing_of(std::span<const Eigen::Vector3f> positions) {
  const Grid grid = finest_grid(positions);
  return spacing_in(grid, sorted_entries(positions, grid));
}

CloudCode encode_cloud(std::span<const Eigen::Vector3f> positions,
                       std::span<const CloudAttribute> attributes, std::size_t most_points) {
  Grid grid = finest_grid(positions);
  std::vector<Entry> entries = sorted_entries(positions, grid);
  thin(entries, most_points);
  CloudCode code{.points = entries.size(), .of = positions.size(), .origin = grid.origin};
  code.spacing = spacing_in(grid, entries);
  if (const double step = code.spacing / 8.0; step > grid.step) {
    grid.step = step;
    sort_by_key(entries, positions, grid);
  }
  code.step = grid.step;
  const std::vector<std::uint64_t> keys = keys_of(entries);
  code.bits = bits_of(keys);
  std::string bytes = planes_of(differences(keys), (3 * code.bits + 7) / 8);
  std::vector<std::uint16_t> first;
  for (const CloudAttribute& attribute : attributes) {
    std::vector<std::uint16_t> values = values_of(attribute, entries);
    if (first.empty()) first = values;
    if (attribute.follows_first) values = ordered_by(first, values);
    const std::size_t different =
        values.empty() ? 1 : std::size_t{*std::ranges::max_element(values)} + 1;
    code.attributes.push_back({attribute.name, different, attribute.follows_first});
    bytes += planes_of(places_in_list(values, different), different > 256 ? 2 : 1);
  }
  code.bytes = deflated(bytes, Repetition::runs);
  return code;
}

}  // namespace skycap::missions::report
