#include <algorithm>

#include "geometry/io/cloud_parsers.h"
#include "geometry/io/cloud_sample.h"
#include "geometry/io/las/las_reader.h"

namespace skycap::geometry {
namespace {

/// Returns the upper 8 of 16 bits. If all numbers of a file are below 256, they are 8-bit values,
/// which violates the specification.
std::vector<std::array<std::uint8_t, 3>> to_bytes(
    const std::vector<std::array<std::uint16_t, 3>>& colours) {
  const bool has_bytes = std::ranges::all_of(
      colours, [](const auto& colour) { return std::ranges::max(colour) <= 255; });
  std::vector<std::array<std::uint8_t, 3>> result;
  result.reserve(colours.size());
  for (const auto& colour : colours) {
    auto& bytes = result.emplace_back();
    for (std::size_t channel = 0; channel < 3; ++channel) {
      bytes[channel] =
          static_cast<std::uint8_t>(has_bytes ? colour[channel] : colour[channel] >> 8);
    }
  }
  return result;
}

}  // namespace

AttributedCloud read_las_cloud(const std::filesystem::path& path) {
  LasReader reader(path);
  AttributedCloud cloud;
  LasPoints points;
  std::vector<std::array<std::uint16_t, 3>> colours;
  while (reader.next(points)) {
    require_few_points(path, cloud.positions.size() + points.positions.size());
    add_positions(path, cloud.positions.size(), points.positions, cloud.positions);
    colours.insert(colours.end(), points.colours.begin(), points.colours.end());
  }
  cloud.colours = to_bytes(colours);
  return cloud;
}

CloudSample sample_las_cloud(const std::filesystem::path& path, std::size_t max_points) {
  LasReader reader(path);
  CloudSample sample;
  sample.of = reader.header().points;
  const double fraction =
      std::min(1.0, static_cast<double>(max_points) / static_cast<double>(sample.of));
  LasPoints points;
  std::vector<std::array<std::uint16_t, 3>> colours;
  while (reader.next_sample(points, fraction)) {
    if (points.positions.empty()) continue;
    if (sample.cloud.positions.empty() &&
        points.positions.front().cwiseAbs().maxCoeff() > farthest_single_coordinate) {
      constexpr double unit = 1000.0;  // [m]
      sample.offset = (points.positions.front() / unit).array().floor() * unit;
      sample.offset.z() = 0.0;
    }
    for (Eigen::Vector3d& position : points.positions) position -= sample.offset;
    add_positions(path, sample.cloud.positions.size(), points.positions, sample.cloud.positions);
    colours.insert(colours.end(), points.colours.begin(), points.colours.end());
  }
  if (sample.cloud.positions.empty()) fail_without_points(path, 0);
  if (fraction == 1.0) sample.of = sample.cloud.positions.size();  // without withheld points
  sample.cloud.colours = to_bytes(colours);
  return sample;
}

std::size_t read_las_positions(const std::filesystem::path& path,
                               const PositionsCallback& callback) {
  LasReader reader(path);
  LasPoints points;
  std::vector<Eigen::Vector3f> chunk;
  std::size_t count = 0;
  const auto all = static_cast<double>(reader.header().points);
  for (double read = 1.0; reader.next(points, points_per_chunk); ++read) {
    chunk.clear();
    add_positions(path, count, points.positions, chunk);
    count += points.positions.size();
    if (!chunk.empty()) callback(chunk, std::min(1.0, read * points_per_chunk / all));
  }
  if (count == 0) fail_without_points(path, 0);
  return 0;
}

}  // namespace skycap::geometry
