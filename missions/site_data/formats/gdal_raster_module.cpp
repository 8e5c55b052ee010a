// Rasters of heights by GDAL; geodata_file.cpp loads the module.
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <gdal_priv.h>

#include "geometry/error.h"
#include "missions/site_data/formats/gdal_dataset.h"
#include "missions/site_data/formats/geodata_file.h"

namespace skycap::missions::site_data {
namespace {

std::optional<double> metres_of_unit(std::string_view unit) {
  if (unit == "m" || unit == "metre" || unit == "meter") return 1.0;
  if (unit == "ft" || unit == "foot") return 0.3048;
  if (unit == "us-ft" || unit == "US survey foot") return 1200.0 / 3937.0;
  return std::nullopt;
}

void read_rows(const std::filesystem::path& file, GDALRasterBand& band,
               const std::array<double, 6>& affine, FileContents& contents) {
  const int columns = band.GetXSize(), rows = band.GetYSize();
  int has_none = 0;
  const double none = band.GetNoDataValue(&has_none);
  const double scale = band.GetScale(), offset = band.GetOffset();
  std::vector<double> row(static_cast<std::size_t>(columns));
  contents.nodes.reserve(row.size() * static_cast<std::size_t>(rows));
  for (int j = 0; j < rows; ++j) {
    if (band.RasterIO(GF_Read, 0, j, columns, 1, row.data(), columns, 1, GDT_Float64, 0, 0,
                      nullptr) != CE_None) {
      fail_file(file, "is damaged in row " + std::to_string(j) + " (" + gdal_complaint() + ")");
    }
    for (int i = 0; i < columns; ++i) {
      double height = row[static_cast<std::size_t>(i)];
      // Some files write their mark of nothing in single precision, and state it in double.
      const bool is_none = has_none != 0 && (height == none || height == static_cast<float>(none));
      height = is_none || !std::isfinite(height) ? std::numeric_limits<double>::quiet_NaN()
                                                 : height * scale + offset;
      const double x = i + 0.5, y = j + 0.5;  // a cell's middle
      contents.nodes.emplace_back(affine[0] + affine[1] * x + affine[2] * y,
                                  affine[3] + affine[4] * x + affine[5] * y, height);
    }
  }
}

}  // namespace

extern "C" void skycap_read_raster(const std::filesystem::path& file, FileContents& contents) {
  const DatasetPtr dataset =
      open_dataset(file, GDAL_OF_RASTER, {"GTiff", "COG", "AAIGrid", "XYZ", "JP2OpenJPEG"});
  contents.format = dataset->GetDriverName();
  GDALRasterBand* const band = dataset->GetRasterBand(1);
  std::array<double, 6> affine;
  if (band == nullptr || dataset->GetGeoTransform(affine.data()) != CE_None) {
    fail_file(file, "does not say where its cells are (no georeference)");
  }
  if (band->GetColorInterpretation() >= GCI_RedBand &&
      band->GetColorInterpretation() <= GCI_BlueBand) {
    fail_file(file, "is a picture; a raster of heights is wanted");
  }
  const std::size_t cells =
      static_cast<std::size_t>(band->GetXSize()) * static_cast<std::size_t>(band->GetYSize());
  if (cells > most_cells) {
    fail_file(file, "has " + std::to_string(cells) + " cells; at most 40 million are read");
  }
  contents.columns = static_cast<std::size_t>(band->GetXSize());
  contents.rows = static_cast<std::size_t>(band->GetYSize());
  contents.right = {affine[1], affine[4]};
  contents.down = {affine[2], affine[5]};
  contents.crs = wkt_of(dataset->GetSpatialRef());
  contents.height_unit = metres_of_unit(band->GetUnitType());
  read_rows(file, *band, affine, contents);
}

}  // namespace skycap::missions::site_data
