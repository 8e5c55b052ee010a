/// Maps and rasters for tests, written by GDAL: how other programs leave them.
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

/// Writes the map; attributes are texts.
void write_map(const std::filesystem::path& file, const WrittenMap& map);

/// Runs SQL in a GeoPackage, and calls `meanwhile` before it is closed.
void run_sql(const std::filesystem::path& file, const std::vector<std::string>& statements,
             const std::function<void()>& meanwhile);

/// A GeoTIFF of 10 x 10 cells of 1 m in EPSG:25832 from (500000, 5316000) south, at the height
/// 500, where column and row are both at least 5 at 512.
struct WrittenRaster {
  double hole = 500.0;      ///< stored in the cells of row 2
  bool has_mask = false;    ///< that marks the cells of row 2 as without data
  bool has_alpha = false;   ///< a second band that does so
  bool has_nodata = false;  ///< declares `hole`
  int bands = 1;            ///< of heights
  std::string unit;         ///< of heights
  double scale = 1.0;       ///< of stored numbers
};
void write_raster(const std::filesystem::path& file, const WrittenRaster& raster);

}  // namespace skycap::testing_support
