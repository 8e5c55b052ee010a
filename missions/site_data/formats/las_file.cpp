#include <algorithm>

#include "geometry/io/las/las_reader.h"
#include "missions/site_data/formats/cell_set.h"
#include "missions/site_data/formats/cloud_files.h"

namespace skycap::missions::site_data {
namespace {

std::optional<double> find_metres_per_unit(int epsg) {
  if (epsg == 9001) return 1.0;
  if (epsg == 9002) return 0.3048;
  if (epsg == 9003) return 1200.0 / 3937.0;  // US survey foot.
  return std::nullopt;
}

void name_reference_system(const geometry::LasReferenceSystem& stated, FileContents& contents) {
  set_wkt(contents, stated.wkt);
  const int horizontal = stated.projected != 0 ? stated.projected : stated.geographic;
  if (stated.wkt.empty() && horizontal != 0) {
    contents.crs = "EPSG:" + std::to_string(horizontal);
    // Values from 5001 to 5199 are obsolete and not reference systems (GeoTIFF 1.0, 6.3.4.1).
    const bool is_system = stated.vertical != 0 && stated.vertical / 200 != 25;
    if (is_system) contents.crs += "+" + std::to_string(stated.vertical);
  }
  if (stated.wkt.empty() && horizontal == 0 && stated.is_user_defined) {
    contents.notes.push_back(
        "its reference system is defined by GeoTIFF parameters, which are not supported");
  }
  contents.height_unit = find_metres_per_unit(stated.vertical_unit);
}

void read_points(geometry::LasReader& input, const std::vector<int>& classes,
                 const CloudDownsampling& downsampling, FileContents& contents) {
  const auto is_selected = [&](int point_class) {
    if (classes.empty()) return point_class != 7 && point_class != 18;
    return std::ranges::find(classes, point_class) != classes.end();
  };
  CellSet cells;
  const Eigen::Vector3d cells_per_unit =
      downsampling.metres_per_unit(contents) / downsampling.spacing;
  geometry::LasPoints points;
  while (input.next(points)) {
    for (std::size_t i = 0; i < points.positions.size(); ++i) {
      const Eigen::Vector3d& position = points.positions[i];
      if (!is_selected(points.classes[i])) continue;
      if (!cells.add(position.cwiseProduct(cells_per_unit))) continue;
      contents.points.push_back(position);
    }
  }
}

}  // namespace

FileContents read_las(const std::filesystem::path& file, const std::vector<int>& classes,
                      const CloudDownsampling& downsampling) {
  geometry::LasReader input(file);
  FileContents contents;
  contents.has_classes = true;
  contents.format = "LAS 1." + std::to_string(input.header().minor) + ", points of format " +
                    std::to_string(input.header().format) +
                    (input.header().is_compressed ? ", compressed (LAZ)" : "");
  name_reference_system(input.reference_system(), contents);
  read_points(input, classes, downsampling, contents);
  return contents;
}

}  // namespace skycap::missions::site_data
