#include "missions/prior/formats/geodata_file.h"

#include "missions/plugins/module.h"

namespace skycap::missions::prior {

FileContents read_map(const std::filesystem::path& file, const std::string& layer) {
  using Read = void(const std::filesystem::path&, const std::string&, FileContents&);
  FileContents contents;
  plugins::module_function<Read>("libskycap_gdal.so", "skycap_read_map")(file, layer, contents);
  return contents;
}

FileContents read_raster(const std::filesystem::path& file) {
  using Read = void(const std::filesystem::path&, FileContents&);
  FileContents contents;
  plugins::module_function<Read>("libskycap_gdal.so", "skycap_read_raster")(file, contents);
  return contents;
}

}  // namespace skycap::missions::prior
