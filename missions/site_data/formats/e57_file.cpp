#include "geometry/io/e57_reader.h"
#include "missions/site_data/formats/cell_set.h"
#include "missions/site_data/formats/cloud_files.h"

namespace skycap::missions::site_data {

FileContents read_e57(const std::filesystem::path& file, const CloudDownsampling& downsampling) {
  geometry::E57Reader input(file);
  FileContents contents;
  contents.format =
      "E57 of " + std::to_string(input.scans()) + (input.scans() == 1 ? " scan" : " scans");
  set_wkt(contents, input.reference_system());
  CellSet cells;
  const Eigen::Vector3d cells_per_unit =
      downsampling.metres_per_unit(contents) / downsampling.spacing;
  geometry::E57Points points;
  while (input.next(points)) {
    for (const Eigen::Vector3d& position : points.positions) {
      if (cells.add(position.cwiseProduct(cells_per_unit))) contents.points.push_back(position);
    }
  }
  note_skipped(input.skipped(), contents);
  if (input.zero_rotations() > 0) {
    contents.notes.push_back(
        std::to_string(input.zero_rotations()) +
        " scans have a rotation of four zeros, which is treated as no rotation");
  }
  return contents;
}

}  // namespace skycap::missions::site_data
