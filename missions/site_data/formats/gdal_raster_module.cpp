// Reader of height rasters based on GDAL. geodata_file.cpp loads this module.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <string>

#include <gdal_priv.h>

#include "geometry/error.h"
#include "missions/site_data/formats/gdal_dataset.h"
#include "missions/site_data/formats/geodata_file.h"

namespace skycap::missions::site_data {
namespace {

struct Unit {
  const char* name;  ///< Name in lower case.
  double metres;
};

constexpr double us_foot = 1200.0 / 3937.0;
constexpr std::array<Unit, 28> units{{{"m", 1.0},
                                      {"metre", 1.0},
                                      {"meter", 1.0},
                                      {"metres", 1.0},
                                      {"meters", 1.0},
                                      {"dm", 0.1},
                                      {"decimetre", 0.1},
                                      {"decimeter", 0.1},
                                      {"cm", 0.01},
                                      {"centimetre", 0.01},
                                      {"centimeter", 0.01},
                                      {"mm", 0.001},
                                      {"millimetre", 0.001},
                                      {"millimeter", 0.001},
                                      {"km", 1000.0},
                                      {"ft", 0.3048},
                                      {"foot", 0.3048},
                                      {"feet", 0.3048},
                                      {"international foot", 0.3048},
                                      {"international feet", 0.3048},
                                      {"us-ft", us_foot},
                                      {"ft-us", us_foot},
                                      {"us_survey_foot", us_foot},
                                      {"us survey foot", us_foot},
                                      {"us survey feet", us_foot},
                                      {"foot_us", us_foot},
                                      {"us foot", us_foot},
                                      {"survey foot", us_foot}}};

void set_unit(const std::string& given, FileContents& contents) {
  std::string name = given;
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.empty()) return;
  const auto unit = std::ranges::find(units, name, &Unit::name);
  if (unit == units.end()) {
    contents.unknown_unit = given;
  } else {
    contents.height_unit = unit->metres;
  }
}

/// Returns the alpha band of a dataset, or null.
GDALRasterBand* find_alpha_band(GDALDataset& dataset) {
  for (int i = 2; i <= dataset.GetRasterCount(); ++i) {
    GDALRasterBand* const band = dataset.GetRasterBand(i);
    if (band->GetColorInterpretation() == GCI_AlphaBand) return band;
  }
  return nullptr;
}

/// Height band with all markers of missing cells: a mask, and an alpha band of any type. GDAL uses
/// only byte alpha bands as masks.
class HeightBand {
 public:
  HeightBand(const std::filesystem::path& file, GDALDataset& dataset, GDALRasterBand& band)
      : file_(file), band_(band), columns_(band.GetXSize()) {
    none_ = band.GetNoDataValue(&has_none_);
    // The nodata mask adds no information and its rounding is unspecified.
    const int flags = band.GetMaskFlags();
    const bool has_mask = (flags & GMF_ALL_VALID) == 0 && (flags & GMF_NODATA) == 0;
    if (has_mask) masks_.push_back(band.GetMaskBand());
    if (GDALRasterBand* const alpha = find_alpha_band(dataset)) masks_.push_back(alpha);
    heights_.resize(static_cast<std::size_t>(columns_));
    opacities_.resize(static_cast<std::size_t>(columns_));
  }

  /// Returns a row of heights; NaN marks missing cells.
  const std::vector<double>& row(int number) {
    read(band_, number, heights_);
    for (double& height : heights_) {
      // Some files store the nodata value in single precision but declare it in double precision.
      const bool is_none =
          has_none_ != 0 && (height == none_ || height == static_cast<float>(none_));
      height = is_none || !std::isfinite(height) ? std::numeric_limits<double>::quiet_NaN()
                                                 : height * band_.GetScale() + band_.GetOffset();
    }
    for (GDALRasterBand* const mask : masks_) {
      read(*mask, number, opacities_);
      for (std::size_t i = 0; i < heights_.size(); ++i) {
        if (opacities_[i] == 0.0) heights_[i] = std::numeric_limits<double>::quiet_NaN();
      }
    }
    return heights_;
  }

 private:
  void read(GDALRasterBand& band, int row, std::vector<double>& values) const {
    if (band.RasterIO(GF_Read, 0, row, columns_, 1, values.data(), columns_, 1, GDT_Float64, 0, 0,
                      nullptr) == CE_None) {
      return;
    }
    fail_file(file_, "is damaged in row " + std::to_string(row) + " (" + last_gdal_error() + ")");
  }

  const std::filesystem::path& file_;
  GDALRasterBand& band_;
  int columns_;
  std::vector<GDALRasterBand*> masks_;
  int has_none_ = 0;
  double none_ = 0.0;
  std::vector<double> heights_, opacities_;
};

void read_rows(const std::filesystem::path& file, GDALDataset& dataset, GDALRasterBand& band,
               const std::array<double, 6>& affine, FileContents& contents) {
  HeightBand heights(file, dataset, band);
  contents.nodes.reserve(contents.columns * contents.rows);
  for (int j = 0; j < band.GetYSize(); ++j) {
    const std::vector<double>& row = heights.row(j);
    for (std::size_t i = 0; i < contents.columns; ++i) {
      const double x = static_cast<double>(i) + 0.5, y = j + 0.5;  // Centre of a cell.
      contents.nodes.emplace_back(affine[0] + affine[1] * x + affine[2] * y,
                                  affine[3] + affine[4] * x + affine[5] * y, row[i]);
    }
  }
}

void reject_images(const std::filesystem::path& file, GDALRasterBand& band) {
  const GDALColorInterp meaning = band.GetColorInterpretation();
  const bool is_colour =
      meaning >= GCI_PaletteIndex && meaning <= GCI_BlackBand && meaning != GCI_AlphaBand;
  if (is_colour) fail_file(file, "is an image; expected a raster of heights");
  if (GDALDataTypeIsComplex(band.GetRasterDataType()) != 0) {
    fail_file(file, "contains complex numbers; expected a raster of heights");
  }
}

/// Adds a note about further bands that are not masks.
void note_bands(GDALDataset& dataset, FileContents& contents) {
  int others = 0;
  for (int i = 2; i <= dataset.GetRasterCount(); ++i) {
    others += dataset.GetRasterBand(i)->GetColorInterpretation() != GCI_AlphaBand ? 1 : 0;
  }
  if (others == 0) return;
  contents.notes.push_back("heights are read from the first of " + std::to_string(others + 1) +
                           " bands");
}

}  // namespace

extern "C" void skycap_read_raster(const std::filesystem::path& file, FileContents& contents) {
  const OpenDataset dataset(file, GDAL_OF_RASTER,
                            {"GTiff", "COG", "AAIGrid", "XYZ", "JP2OpenJPEG"});
  contents.format = dataset->GetDriverName();
  contents.notes = dataset.notes();
  GDALRasterBand* const band = dataset->GetRasterBand(1);
  std::array<double, 6> affine;
  if (band == nullptr || dataset->GetGeoTransform(affine.data()) != CE_None) {
    fail_file(file, "has no georeference");
  }
  reject_images(file, *band);
  const std::size_t cells =
      static_cast<std::size_t>(band->GetXSize()) * static_cast<std::size_t>(band->GetYSize());
  if (cells > max_cells) {
    fail_file(file, "has " + std::to_string(cells) + " cells; the maximum is 40 million");
  }
  contents.columns = static_cast<std::size_t>(band->GetXSize());
  contents.rows = static_cast<std::size_t>(band->GetYSize());
  contents.right = {affine[1], affine[4]};
  contents.down = {affine[2], affine[5]};
  contents.crs = to_wkt(dataset->GetSpatialRef());
  set_unit(band->GetUnitType(), contents);
  note_bands(*dataset, contents);
  read_rows(file, *dataset, *band, affine, contents);
}

}  // namespace skycap::missions::site_data
