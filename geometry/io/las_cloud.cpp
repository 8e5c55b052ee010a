#include <algorithm>

#include "geometry/io/cloud_parsers.h"
#include "geometry/io/las_reader.h"

namespace skycap::geometry {

AttributedCloud read_las_cloud(const std::filesystem::path& path) {
  LasReader reader(path);
  AttributedCloud cloud;
  LasPoints points;
  while (reader.next(points)) {
    require_few_points(path, cloud.positions.size() + points.positions.size());
    add_positions(path, cloud.positions.size(), points.positions, cloud.positions);
    cloud.colours.insert(cloud.colours.end(), points.colours.begin(), points.colours.end());
  }
  return cloud;
}

void read_las_positions(const std::filesystem::path& path, const TakePositions& take) {
  LasReader reader(path);
  LasPoints points;
  std::vector<Eigen::Vector3f> piece;
  std::size_t count = 0;
  const auto all = static_cast<double>(reader.header().points);
  for (double read = 1.0; reader.next(points, piece_size); ++read) {
    piece.clear();
    add_positions(path, count, points.positions, piece);
    count += points.positions.size();
    if (!piece.empty()) take(piece, std::min(1.0, read * piece_size / all));
  }
  if (count == 0) fail_cloud(path, "holds no points");
}

}  // namespace skycap::geometry
