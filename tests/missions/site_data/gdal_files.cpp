#include "tests/missions/site_data/gdal_files.h"

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

namespace skycap::testing_support {
namespace {

struct Close {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, Close>;

GDALDriver& driver_named(const char* name) {
  GDALAllRegister();
  GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName(name);
  if (driver == nullptr) throw std::runtime_error(std::string("GDAL has no driver ") + name);
  return *driver;
}

OGRSpatialReference make_reference_system(int epsg) {
  OGRSpatialReference system;
  system.importFromEPSG(epsg);
  system.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return system;
}

}  // namespace

void write_map(const std::filesystem::path& file, const WrittenMap& map) {
  const Dataset dataset(
      driver_named(map.driver).Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (!dataset) throw std::runtime_error(file.string() + " cannot be made");
  OGRSpatialReference system = make_reference_system(map.epsg != 0 ? map.epsg : 4326);
  OGRLayer* const layer = dataset->CreateLayer(
      file.stem().c_str(), map.epsg != 0 ? &system : nullptr, wkbPolygon, nullptr);
  for (const auto& [name, value] : map.attributes) {
    OGRFieldDefn field(name.c_str(), OFTString);
    layer->CreateField(&field);
  }
  OGRFeature feature(layer->GetLayerDefn());
  int index = 0;
  for (const auto& [name, value] : map.attributes) feature.SetField(index++, value.c_str());
  OGRLinearRing ring;
  for (const auto& [x, y] : std::initializer_list<std::pair<double, double>>{
           {9, 48}, {9.0002, 48}, {9.0002, 48.0002}, {9, 48.0002}, {9, 48}}) {
    ring.addPoint(x, y);
  }
  OGRPolygon polygon;
  polygon.addRing(&ring);
  feature.SetGeometry(&polygon);
  if (layer->CreateFeature(&feature) != OGRERR_NONE) {
    throw std::runtime_error(file.string() + " cannot be filled");
  }
}

void run_sql(const std::filesystem::path& file, const std::vector<std::string>& statements,
             const std::function<void()>& meanwhile) {
  GDALAllRegister();
  const Dataset dataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
  if (!dataset) throw std::runtime_error(file.string() + " cannot be opened");
  for (const std::string& statement : statements) {
    OGRLayer* const result = dataset->ExecuteSQL(statement.c_str(), nullptr, nullptr);
    if (result != nullptr) dataset->ReleaseResultSet(result);
  }
  meanwhile();
}

void write_raster(const std::filesystem::path& file, const WrittenRaster& raster) {
  constexpr int side = 10;
  CPLSetConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
  const int bands = raster.bands + (raster.has_alpha ? 1 : 0);
  const std::array<const char*, 2> options{raster.has_alpha ? "ALPHA=YES" : nullptr, nullptr};
  const Dataset dataset(driver_named("GTiff").Create(file.c_str(), side, side, bands, GDT_Float32,
                                                     const_cast<char**>(options.data())));
  if (!dataset) throw std::runtime_error(file.string() + " cannot be made");
  std::array<double, 6> affine{500000.0, 1.0, 0.0, 5316000.0, 0.0, -1.0};
  dataset->SetGeoTransform(affine.data());
  const OGRSpatialReference system = make_reference_system(25832);
  dataset->SetSpatialRef(&system);
  std::array<float, side * side> heights{}, opaque{};
  std::array<std::uint8_t, side * side> mask{};
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const auto cell = static_cast<std::size_t>(row * side + column);
      const double height = row == 2 ? raster.hole : row >= 5 && column >= 5 ? 512.0 : 500.0;
      const bool is_there = row != 2;
      heights[cell] = static_cast<float>(is_there ? height / raster.scale : height);
      opaque[cell] = is_there ? 255.0F : 0.0F;
      mask[cell] = is_there ? 255 : 0;
    }
  }
  const auto write = [&](GDALRasterBand& band, void* values, GDALDataType type) {
    if (band.RasterIO(GF_Write, 0, 0, side, side, values, side, side, type, 0, 0, nullptr) !=
        CE_None) {
      throw std::runtime_error(file.string() + " cannot be filled");
    }
  };
  for (int band = 1; band <= raster.bands; ++band) {
    write(*dataset->GetRasterBand(band), heights.data(), GDT_Float32);
  }
  GDALRasterBand& first = *dataset->GetRasterBand(1);
  if (!raster.unit.empty()) first.SetUnitType(raster.unit.c_str());
  if (raster.scale != 1.0) first.SetScale(raster.scale);
  if (raster.has_nodata) first.SetNoDataValue(raster.hole);
  if (raster.has_alpha) write(*dataset->GetRasterBand(bands), opaque.data(), GDT_Float32);
  if (raster.has_mask) {
    first.CreateMaskBand(GMF_PER_DATASET);
    write(*first.GetMaskBand(), mask.data(), GDT_Byte);
  }
}

void write_image(const std::filesystem::path& file, const WrittenImage& image) {
  constexpr int side = 100;
  const GDALDataType type = image.has_16_bits ? GDT_UInt16 : GDT_Byte;
  const Dataset dataset(
      driver_named("GTiff").Create(file.c_str(), side, side, image.bands, type, nullptr));
  if (!dataset) throw std::runtime_error(file.string() + " cannot be made");
  std::array<double, 6> affine{500005.0 - side / 2, 1, 0, 5315995.0 + side / 2, 0, -1};
  if (image.has_position) dataset->SetGeoTransform(affine.data());
  const OGRSpatialReference system = make_reference_system(25832);
  if (image.has_crs) dataset->SetSpatialRef(&system);
  for (int i = 1; i <= image.bands; ++i) dataset->GetRasterBand(i)->Fill(200.0 / i);
}

}  // namespace skycap::testing_support
