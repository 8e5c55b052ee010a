#include "geometry/io/cloud_parsers.h"
#include "geometry/io/las_reader.h"

namespace skycap::geometry {

AttributedCloud read_las_cloud(const std::filesystem::path& path) {
  LasReader reader(path);
  AttributedCloud cloud;
  LasPoints points;
  while (reader.next(points)) {
    for (const Eigen::Vector3d& position : points.positions) {
      cloud.positions.push_back(
          cloud_position(path, cloud.positions.size(), position.x(), position.y(), position.z()));
    }
    cloud.colours.insert(cloud.colours.end(), points.colours.begin(), points.colours.end());
  }
  return cloud;
}

}  // namespace skycap::geometry
