#include "missions/site_data/formats/geodata_file.h"

#include "missions/support/module.h"

namespace skycap::missions::site_data {

FileContents read_map(const std::filesystem::path& file, const std::string& layer) {
  using Read = void(const std::filesystem::path&, const std::string&, FileContents&);
  FileContents contents;
  support::module_function<Read>("libskycap_gdal.so", "skycap_read_map")(file, layer, contents);
  return contents;
}

FileContents read_raster(const std::filesystem::path& file) {
  using Read = void(const std::filesystem::path&, FileContents&);
  FileContents contents;
  support::module_function<Read>("libskycap_gdal.so", "skycap_read_raster")(file, contents);
  return contents;
}

}  // namespace skycap::missions::site_data
