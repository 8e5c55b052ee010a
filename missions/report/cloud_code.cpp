#include "missions/report/cloud_code.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "geometry/pose/space_curve.h"
#include "missions/report/script_text.h"

namespace skycap::missions::report {
namespace {

/// Selects `max` entries evenly along the list.
void decimate(std::vector<geometry::CurveEntry>& entries, std::size_t max) {
  if (entries.size() <= max) return;
  for (std::size_t i = 0; i < max; ++i)
    entries[i] = entries[(2 * i + 1) * entries.size() / (2 * max)];
  entries.resize(max);
}

template <class Values>
std::string split_byte_planes(const Values& values, int planes) {
  std::string bytes(values.size() * static_cast<std::size_t>(planes), '\0');
  auto next = bytes.begin();
  for (int plane = 0; plane < planes; ++plane) {
    for (const auto value : values) *next++ = static_cast<char>(value >> (8 * plane));
  }
  return bytes;
}

/// Returns the difference between each key and its predecessor.
std::vector<std::uint64_t> differences(std::span<const std::uint64_t> keys) {
  std::vector<std::uint64_t> steps(keys.begin(), keys.end());
  for (std::size_t i = keys.size(); i-- > 1;) steps[i] -= keys[i - 1];
  return steps;
}

std::vector<std::uint64_t> collect_keys(std::span<const geometry::CurveEntry> entries) {
  std::vector<std::uint64_t> keys;
  keys.reserve(entries.size());
  for (const geometry::CurveEntry& entry : entries) keys.push_back(entry.key);
  return keys;
}

double spacing_in(const geometry::CurveGrid& grid, std::span<const geometry::CurveEntry> entries) {
  return entries.size() > 1
             ? compute_key_spacing(collect_keys(entries), geometry::CurveGrid::max_bits) * grid.step
             : 0.0;
}

/// Returns the number of bits per cell index required by the keys.
int count_bits(std::span<const std::uint64_t> keys) {
  const int width = keys.empty() ? 0 : static_cast<int>(std::bit_width(keys.back()));
  return std::max(1, (width + 2) / 3);
}

std::vector<std::uint16_t> quantize_values(const CloudAttribute& attribute,
                                           std::span<const geometry::CurveEntry> entries) {
  std::vector<std::uint16_t> values;
  values.reserve(entries.size());
  for (const geometry::CurveEntry& entry : entries) values.push_back(attribute.values[entry.index]);
  return values;
}

}  // namespace

double compute_key_spacing(std::span<const std::uint64_t> keys, int bits) {
  // Neighbouring keys that differ in bit b (from 0) belong to different cells of all sizes up to
  // 2^(b / 3).
  // Number of occupied cells by size.
  std::vector<std::size_t> cells(static_cast<std::size_t>(bits) + 1, 1);
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const std::uint64_t change = keys[i] ^ keys[i - 1];
    if (change == 0) continue;
    const int level = (static_cast<int>(std::bit_width(change)) - 1) / 3;
    for (int size = 0; size <= std::min(level, bits); ++size)
      ++cells[static_cast<std::size_t>(size)];
  }
  const double half_size = static_cast<double>(keys.size()) / 2.0;
  for (std::size_t size = 0; size < cells.size(); ++size) {
    const auto here = static_cast<double>(cells[size]);
    if (here > half_size) continue;
    if (size == 0) return 1.0;
    const auto finer = static_cast<double>(cells[size - 1]);
    const double part = std::log(half_size / here) / std::log(finer / here);
    return std::exp2(static_cast<double>(size) - part) / std::numbers::sqrt2;
  }
  return std::exp2(bits);
}

double compute_spacing(std::span<const Eigen::Vector3f> positions) {
  const geometry::CurveGrid grid = geometry::finest_grid(positions);
  return spacing_in(grid, geometry::along_curve(positions, grid));
}

CloudCode encode_cloud(std::span<const Eigen::Vector3f> positions,
                       std::span<const CloudAttribute> attributes, std::size_t max_points) {
  geometry::CurveGrid grid = geometry::finest_grid(positions);
  std::vector<geometry::CurveEntry> entries = geometry::along_curve(positions, grid);
  decimate(entries, max_points);
  CloudCode code{.points = entries.size(), .of = positions.size(), .origin = grid.origin};
  code.spacing = spacing_in(grid, entries);
  if (const double step = code.spacing / 8.0; step > grid.step) {
    grid.step = step;
    geometry::sort_along_curve(entries, positions, grid);
  }
  code.step = grid.step;
  const std::vector<std::uint64_t> keys = collect_keys(entries);
  code.bits = count_bits(keys);
  std::string bytes = split_byte_planes(differences(keys), (3 * code.bits + 7) / 8);
  for (const CloudAttribute& attribute : attributes) {
    const std::vector<std::uint16_t> values = quantize_values(attribute, entries);
    const std::size_t different =
        values.empty() ? 1 : std::size_t{*std::ranges::max_element(values)} + 1;
    code.attributes.push_back({attribute.name, different});
    bytes += split_byte_planes(values, different > 256 ? 2 : 1);
  }
  code.bytes = deflated(bytes, Repetition::runs);
  return code;
}

}  // namespace skycap::missions::report
