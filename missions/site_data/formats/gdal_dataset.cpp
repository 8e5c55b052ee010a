#include "missions/site_data/formats/gdal_dataset.h"

#include <algorithm>
#include <mutex>

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogr_srs_api.h>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {
namespace {

/// Once: the settings hold for the whole program, in which nothing else uses GDAL.
void prepare_gdal() {
  static std::once_flag once;
  std::call_once(once, [] {
    CPLSetErrorHandler(CPLQuietErrorHandler);
    CPLSetConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "TRUE");
    CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");  // neither reads nor writes .aux.xml
    CPLSetConfigOption("GDAL_HTTP_MAX_RETRY", "0");
    CPLSetConfigOption("OGR_SQLITE_LOAD_EXTENSIONS", nullptr);
    CPLSetConfigOption("OSM_USE_CUSTOM_INDEXING", "NO");  // wants nodes in the order of their ids
    OSRSetPROJEnableNetwork(0);
    GDALAllRegister();
  });
}

}  // namespace

void CloseDataset::operator()(GDALDataset* dataset) const { GDALClose(dataset); }

std::string gdal_complaint() {
  std::string text = CPLGetLastErrorMsg();
  std::ranges::replace(text, '\n', ' ');
  return text.substr(0, 300);
}

DatasetPtr open_dataset(const std::filesystem::path& file, unsigned kind,
                        const std::vector<const char*>& drivers) {
  prepare_gdal();
  std::vector<const char*> list = drivers;
  list.push_back(nullptr);
  CPLErrorReset();
  // An absolute name is never one of GDAL's own, such as /vsicurl/ or "MEM:".
  const std::string name = std::filesystem::absolute(file).lexically_normal().string();
  if (name.starts_with("/vsi")) fail_file(file, "has a name that GDAL would not take for a file's");
  DatasetPtr dataset(GDALDataset::Open(name.c_str(),
                                       kind | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, list.data(),
                                       nullptr, nullptr));
  if (!dataset) {
    const std::string complaint = gdal_complaint();
    fail_file(file, "cannot be read" + (complaint.empty() ? "" : " (GDAL: " + complaint + ")"));
  }
  return dataset;
}

std::string wkt_of(const OGRSpatialReference* system) {
  if (system == nullptr) return {};
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  char* text = nullptr;
  std::string result;
  if (system->exportToWkt(&text, options) == OGRERR_NONE) result = text;
  CPLFree(text);
  return result;
}

}  // namespace skycap::missions::site_data
