/// Maps and rasters written by GDAL, as other programs create them.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace skycap::testing_support {

/// A square of 0.0002 degrees at 48 N, 9 E: 14.9 m east by 22.2 m north.
struct WrittenMap {
  const char* driver = "GPKG";
  int epsg = 4326;  ///< 0: without a reference system
  std::map<std::string, std::string> attributes;
};

/// Writes the map. Attributes are strings.
void write_map(const std::filesystem::path& file, const WrittenMap& map);

/// Runs SQL in a GeoPackage and calls `meanwhile` before closing it.
void run_sql(const std::filesystem::path& file, const std::vector<std::string>& statements,
             const std::function<void()>& meanwhile);

/// GeoTIFF of 10 x 10 cells of 1 m in EPSG:25832, from (500000, 5316000) to the south. The height
/// is 500, and 512 where both column and row are at least 5.
struct WrittenRaster {
  double hole = 500.0;      ///< value of the cells in row 2
  bool has_mask = false;    ///< a mask marks the cells of row 2 as no data
  bool has_alpha = false;   ///< an alpha band marks the cells of row 2 as no data
  bool has_nodata = false;  ///< declares `hole` as the no-data value
  int bands = 1;            ///< number of height bands
  std::string unit;         ///< unit of the heights
  double scale = 1.0;       ///< scale of the stored numbers
};
void write_raster(const std::filesystem::path& file, const WrittenRaster& raster);

/// GeoTIFF of 100 x 100 pixels of 1 m, whose centre is at (500005, 5315995) in EPSG:25832.
struct WrittenImage {
  int bands = 3;
  bool has_16_bits = false;
  bool has_crs = true;
  bool has_position = true;
};
void write_image(const std::filesystem::path& file, const WrittenImage& image);

}  // namespace skycap::testing_support
