#include "missions/site_data/formats/photogrammetry_offset.h"

#include <cctype>
#include <sstream>
#include <vector>

#include <pugixml.hpp>

#include "geometry/io/file.h"
#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// Returns the EPSG code of a header such as "WGS84 UTM 32N" or "EPSG:32632"; empty for others.
std::string find_crs(const std::string& header) {
  std::istringstream words(header);
  std::string datum, projection, zone;
  words >> datum >> projection >> zone;
  if (datum.starts_with("EPSG:") || datum.starts_with("epsg:")) return "EPSG:" + datum.substr(5);
  if (datum != "WGS84" || projection != "UTM" || zone.size() < 2) return {};
  const char pole = static_cast<char>(std::toupper(static_cast<unsigned char>(zone.back())));
  int number = 0;
  for (const char digit : zone.substr(0, zone.size() - 1)) {
    if (std::isdigit(static_cast<unsigned char>(digit)) == 0) return {};
    number = 10 * number + (digit - '0');
  }
  constexpr int zones = 60, northern = 32600, southern = 32700;
  if (number < 1 || number > zones || (pole != 'N' && pole != 'S')) return {};
  return "EPSG:" + std::to_string((pole == 'N' ? northern : southern) + number);
}

PhotogrammetryOffset read_odm(const fs::path& file) {
  std::istringstream lines(geometry::read_file(file));
  std::string header, offsets;
  std::getline(lines, header);
  std::getline(lines, offsets);
  PhotogrammetryOffset result{file, find_crs(header), Eigen::Vector3d::Zero()};
  if (result.crs.empty()) {
    fail_file(file, "line 1 must be a coordinate system such as \"WGS84 UTM 32N\" or EPSG:32632");
  }
  std::istringstream numbers(offsets);
  if (!(numbers >> result.offset.x() >> result.offset.y())) {
    fail_file(file, "line 2 must contain the easting and the northing that ODM subtracted");
  }
  return result;
}

PhotogrammetryOffset read_pix4d(const fs::path& file) {
  std::istringstream numbers(geometry::read_file(file));
  PhotogrammetryOffset result{file, {}, Eigen::Vector3d::Zero()};
  if (!(numbers >> result.offset.x() >> result.offset.y() >> result.offset.z())) {
    fail_file(file, "line 1 must contain the offset x, y and z");
  }
  return result;
}

/// Returns the offset of a file with the root element ModelMetadata and an element SRSOrigin, or
/// nullopt for other files with this name.
std::optional<PhotogrammetryOffset> read_model_metadata(const fs::path& file) {
  const std::string bytes = geometry::read_file(file);
  pugi::xml_document document;
  if (!document.load_buffer(bytes.data(), bytes.size())) return std::nullopt;
  const pugi::xml_node model = document.child("ModelMetadata"), origin = model.child("SRSOrigin");
  if (!origin) return std::nullopt;
  PhotogrammetryOffset result{file, {}, Eigen::Vector3d::Zero()};
  const std::string system = model.child_value("SRS");
  if (system.starts_with("EPSG:")) result.crs = system;
  std::istringstream numbers(origin.child_value());
  char first = 0, second = 0;
  if (!(numbers >> result.offset.x() >> first >> result.offset.y() >> second >>
        result.offset.z()) ||
      first != ',' || second != ',') {
    fail_file(file, "SRSOrigin must contain the origin as x,y,z");
  }
  return result;
}

/// Returns the offset of metadata.xml in the folder of the mesh or, for tiles, up to two folders
/// above it.
std::optional<PhotogrammetryOffset> find_model_metadata(const fs::path& folder) {
  for (const fs::path& file : {folder / "metadata.xml", folder / ".." / "metadata.xml",
                               folder / ".." / ".." / "metadata.xml"}) {
    if (!is_file(file)) continue;
    if (auto found = read_model_metadata(file.lexically_normal())) return found;
  }
  return std::nullopt;
}

/// Returns the only file of the folder that ends in "_offset.xyz", if there is exactly one.
std::optional<fs::path> find_pix4d(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure)) {
    if (entry.path().filename().string().ends_with("_offset.xyz")) found.push_back(entry.path());
  }
  if (found.size() != 1) return std::nullopt;
  return found.front();
}

}  // namespace

std::optional<PhotogrammetryOffset> find_photogrammetry_offset(const fs::path& mesh) {
  const fs::path folder = mesh.has_parent_path() ? mesh.parent_path() : fs::path(".");
  if (mesh.stem().string().ends_with("_geo")) {
    for (const fs::path& file :
         {folder / "coords.txt", folder / ".." / "odm_georeferencing" / "coords.txt"}) {
      if (is_file(file)) return read_odm(file.lexically_normal());
    }
  }
  const fs::path own = folder / (mesh.stem().string() + "_offset.xyz");
  if (is_file(own)) return read_pix4d(own);
  if (const auto project = find_pix4d(folder)) return read_pix4d(*project);
  return find_model_metadata(folder);
}

}  // namespace skycap::missions::site_data
