/// Georeferenced images, such as orthophotos: the interface of their reader in the GDAL module.
#pragma once

#include <array>
#include <filesystem>
#include <string>

namespace skycap::missions::site_data {

/// Part of an image [px], from the top left corner.
struct ImageWindow {
  int column = 0, row = 0;
  int columns = 0, rows = 0;
};

struct FileImage {
  int columns = 0, rows = 0;       ///< Size of the file [px].
  std::array<double, 6> affine{};  ///< GDAL's geotransform: from pixels to file coordinates.
  std::string crs;                 ///< WKT; empty without a reference system.
};

/// Reads size and position of an image: GeoTIFF or JPEG 2000. Throws Error{bad_file}, also for
/// files that are not images of 8 bits per colour.
FileImage read_image_header(const std::filesystem::path& file);

/// Returns a part of an image as JPEG with at most `max_side` pixels per side. Throws
/// Error{bad_file}.
std::string read_image(const std::filesystem::path& file, const ImageWindow& window, int max_side);

}  // namespace skycap::missions::site_data
