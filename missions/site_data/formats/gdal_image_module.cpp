// Reader of georeferenced images based on GDAL. site_image.cpp loads this module.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <cpl_vsi.h>
#include <gdal_priv.h>

#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/formats/file_image.h"
#include "missions/site_data/formats/gdal_dataset.h"

namespace skycap::missions::site_data {
namespace {

constexpr int colours = 3;
const std::vector<const char*> image_drivers{"GTiff", "COG", "JP2OpenJPEG"};

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using MemoryDataset = std::unique_ptr<GDALDataset, CloseDataset>;

/// Returns the bands of red, green and blue, which are the same band for grey and palette images.
std::array<GDALRasterBand*, colours> colour_bands(const std::filesystem::path& file,
                                                  GDALDataset& dataset) {
  const int count = dataset.GetRasterCount();
  std::array<GDALRasterBand*, colours> bands{};
  for (int i = 0; i < colours; ++i) {
    if (count > 0)
      bands[static_cast<std::size_t>(i)] = dataset.GetRasterBand(count < 3 ? 1 : i + 1);
  }
  constexpr std::array meanings{GCI_RedBand, GCI_GreenBand, GCI_BlueBand};
  for (int i = 1; i <= count; ++i) {
    const auto found =
        std::ranges::find(meanings, dataset.GetRasterBand(i)->GetColorInterpretation());
    if (found == meanings.end()) continue;
    bands[static_cast<std::size_t>(found - meanings.begin())] = dataset.GetRasterBand(i);
  }
  for (GDALRasterBand* const band : bands) {
    if (band == nullptr || band->GetRasterDataType() != GDT_Byte) {
      fail_file(file,
                "is not an image of 8 bits per colour; convert it with gdal_translate -ot Byte "
                "-scale");
    }
  }
  return bands;
}

/// Replaces the numbers of a palette by one of their colours.
void apply_palette(GDALRasterBand& band, int colour, std::vector<std::uint8_t>& pixels) {
  const GDALColorTable* const table = band.GetColorTable();
  if (table == nullptr) return;
  for (std::uint8_t& pixel : pixels) {
    const GDALColorEntry* const entry = table->GetColorEntry(pixel);
    if (entry == nullptr) continue;
    const short value = colour == 0 ? entry->c1 : colour == 1 ? entry->c2 : entry->c3;
    pixel = static_cast<std::uint8_t>(value);
  }
}

/// Returns a dataset in memory as JPEG.
std::string encode_jpeg(const std::filesystem::path& file, GDALDataset& image) {
  GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName("JPEG");
  if (driver == nullptr) fail_file(file, "cannot be converted: GDAL has no writer of JPEG");
  const std::string name = "/vsimem/skycap_image.jpg";
  std::array<char, 11> quality{"QUALITY=80"};
  std::array<char*, 2> options{quality.data(), nullptr};
  const MemoryDataset written(
      driver->CreateCopy(name.c_str(), &image, FALSE, options.data(), nullptr, nullptr));
  if (!written) fail_file(file, "cannot be converted (" + last_gdal_error() + ")");
  vsi_l_offset size = 0;
  const GByte* const bytes = VSIGetMemFileBuffer(name.c_str(), &size, FALSE);
  std::string jpeg(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size));
  VSIUnlink(name.c_str());
  return jpeg;
}

}  // namespace

extern "C" void skycap_read_image_header(const std::filesystem::path& file, FileImage& image) {
  const OpenDataset dataset(file, GDAL_OF_RASTER, image_drivers);
  colour_bands(file, *dataset);
  if (dataset->GetGeoTransform(image.affine.data()) != CE_None) {
    fail_file(file, "has no georeference");
  }
  image.columns = dataset->GetRasterXSize();
  image.rows = dataset->GetRasterYSize();
  image.crs = to_wkt(dataset->GetSpatialRef());
}

extern "C" void skycap_read_image(const std::filesystem::path& file, const ImageWindow& window,
                                  int max_side, std::string& jpeg) {
  const OpenDataset dataset(file, GDAL_OF_RASTER, image_drivers);
  const std::array<GDALRasterBand*, colours> bands = colour_bands(file, *dataset);
  const double scale =
      std::min(1.0, static_cast<double>(max_side) / std::max(window.columns, window.rows));
  const auto scaled = [&](int side) {
    return std::max(1, static_cast<int>(std::lround(scale * side)));
  };
  const int columns = scaled(window.columns), rows = scaled(window.rows);
  GDALDriver* const memory = GetGDALDriverManager()->GetDriverByName("MEM");
  if (memory == nullptr) fail_file(file, "cannot be converted: GDAL has no driver MEM");
  const MemoryDataset image(memory->Create("", columns, rows, colours, GDT_Byte, nullptr));
  if (!image) fail_file(file, "cannot be converted (" + last_gdal_error() + ")");
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(columns) *
                                   static_cast<std::size_t>(rows));
  for (int colour = 0; colour < colours; ++colour) {
    GDALRasterBand& band = *bands[static_cast<std::size_t>(colour)];
    GDALRasterIOExtraArg how;
    INIT_RASTERIO_EXTRA_ARG(how);
    how.eResampleAlg = band.GetColorTable() == nullptr ? GRIORA_Average : GRIORA_NearestNeighbour;
    if (band.RasterIO(GF_Read, window.column, window.row, window.columns, window.rows,
                      pixels.data(), columns, rows, GDT_Byte, 0, 0, &how) != CE_None) {
      fail_file(file, "is damaged (" + last_gdal_error() + ")");
    }
    apply_palette(band, colour, pixels);
    if (image->GetRasterBand(colour + 1)
            ->RasterIO(GF_Write, 0, 0, columns, rows, pixels.data(), columns, rows, GDT_Byte, 0, 0,
                       nullptr) != CE_None) {
      fail_file(file, "cannot be converted (" + last_gdal_error() + ")");
    }
  }
  jpeg = encode_jpeg(file, *image);
}

}  // namespace skycap::missions::site_data
