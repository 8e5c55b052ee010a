#include "missions/site_data/formats/gdal_dataset.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <system_error>

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogr_srs_api.h>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {
namespace {

namespace fs = std::filesystem;

/// Configures GDAL once. The settings apply to the whole process, which does not use GDAL
/// elsewhere.
void prepare_gdal() {
  static std::once_flag once;
  std::call_once(once, [] {
    CPLSetErrorHandler(CPLQuietErrorHandler);
    CPLSetConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "TRUE");
    // Disables reading and writing of .aux.xml files.
    CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");
    CPLSetConfigOption("GDAL_HTTP_MAX_RETRY", "0");
    CPLSetConfigOption("OGR_SQLITE_LOAD_EXTENSIONS", nullptr);
    // The custom index requires nodes in ascending order of id.
    CPLSetConfigOption("OSM_USE_CUSTOM_INDEXING", "NO");
    // Large .osm files have their indices there instead of in the working directory.
    std::error_code failure;
    const fs::path temporary = fs::temp_directory_path(failure);
    if (!failure) CPLSetConfigOption("CPL_TMPDIR", temporary.c_str());
    OSRSetPROJEnableNetwork(0);
    GDALAllRegister();
  });
}

bool is_database(const fs::path& file) {
  std::array<char, 16> beginning{};
  std::ifstream(file, std::ios::binary).read(beginning.data(), beginning.size());
  return std::string(beginning.data(), 15) == "SQLite format 3";
}

/// Returns true if a non-empty file exists whose name is that of `file` plus `more`, such as
/// "town.gpkg-wal".
bool has_nonempty_sibling(const fs::path& file, const char* more) {
  std::error_code failure;
  const auto size = fs::file_size(file.string() + more, failure);
  return !failure && size > 0;
}

void copy_file(const fs::path& file, const fs::path& from, const fs::path& to) {
  std::error_code failure;
  fs::copy_file(from, to, failure);
  if (!failure) fs::permissions(to, fs::perms::owner_read | fs::perms::owner_write, failure);
  if (failure) {
    fail_file(file,
              "cannot be read: a temporary copy cannot be created (" + failure.message() + ")");
  }
}

}  // namespace

CopyFolder::~CopyFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

void CopyFolder::make(const fs::path& file) {
  std::error_code failure;
  std::string name = (fs::temp_directory_path(failure) / "skycap-XXXXXX").string();
  if (failure || ::mkdtemp(name.data()) == nullptr) {
    fail_file(file, "cannot be read: a temporary copy requires a folder for temporary files");
  }
  path_ = name;
}

/// Returns the file itself, or a copy if reading would write next to it. This applies to databases
/// with a log and Shapefiles without an index.
fs::path OpenDataset::readable(const fs::path& file) {
  if (is_database(file)) {
    const bool has_log =
        has_nonempty_sibling(file, "-wal") || has_nonempty_sibling(file, "-journal");
    is_immutable_ = !has_log;
    if (!has_log) return file;
    copy_.make(file);
    const fs::path copy = copy_.path() / file.filename();
    for (const char* more : {"", "-wal", "-journal"}) {
      if (more[0] == '\0' || has_nonempty_sibling(file, more)) {
        copy_file(file, file.string() + more, copy.string() + more);
      }
    }
    notes_.emplace_back("read from a copy that includes the changes in its log file");
    return copy;
  }
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto sibling = [&](const char* other) { return fs::path(file).replace_extension(other); };
  if (extension != ".shp" || fs::exists(sibling(".shx")) || fs::exists(sibling(".SHX")))
    return file;
  copy_.make(file);
  const fs::path copy = copy_.path() / (file.stem().string() + ".shp");
  copy_file(file, file, copy);
  for (const char* other : {".dbf", ".prj", ".cpg", ".DBF", ".PRJ", ".CPG"}) {
    if (fs::exists(sibling(other))) {
      copy_file(file, sibling(other), fs::path(copy).replace_extension(other));
    }
  }
  CPLSetConfigOption("SHAPE_RESTORE_SHX", "YES");
  notes_.emplace_back("read from a copy with a rebuilt index (.shx)");
  return copy;
}

OpenDataset::OpenDataset(const fs::path& file, unsigned kind,
                         const std::vector<const char*>& drivers) {
  prepare_gdal();
  std::vector<const char*> list = drivers;
  list.push_back(nullptr);
  CPLErrorReset();
  CPLSetConfigOption("SHAPE_RESTORE_SHX", "NO");  // Restoring would write next to the file.
  // Absolute paths cannot match GDAL's special names such as /vsicurl/ or "MEM:".
  const std::string name = fs::absolute(file).lexically_normal().string();
  if (name.starts_with("/vsi")) fail_file(file, "has a file name that GDAL does not support");
  const std::string opened = readable(name).string();
  const std::array<const char*, 2> immutable{"IMMUTABLE=YES", nullptr};
  dataset_ = GDALDataset::Open(opened.c_str(), kind | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                               list.data(), is_immutable_ ? immutable.data() : nullptr, nullptr);
  if (dataset_ == nullptr) {
    const std::string error_message = last_gdal_error();
    fail_file(file,
              "cannot be read" + (error_message.empty() ? "" : " (GDAL: " + error_message + ")"));
  }
}

OpenDataset::~OpenDataset() { GDALClose(dataset_); }

std::string last_gdal_error() {
  std::string text = CPLGetLastErrorMsg();
  std::ranges::replace(text, '\n', ' ');
  return text.substr(0, 300);
}

std::string to_wkt(const OGRSpatialReference* system) {
  if (system == nullptr) return {};
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  char* text = nullptr;
  std::string result;
  if (system->exportToWkt(&text, options) == OGRERR_NONE) result = text;
  CPLFree(text);
  return result;
}

}  // namespace skycap::missions::site_data
