/// How this program opens files with GDAL, for the sources of its module: no driver that follows
/// names to other files or hosts, no files of others beside the one that is named.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

class GDALDataset;
class OGRSpatialReference;

namespace skycap::missions::site_data {

struct CloseDataset {
  void operator()(GDALDataset* dataset) const;
};
using DatasetPtr = std::unique_ptr<GDALDataset, CloseDataset>;

/// Opens a file for reading with one of the drivers. Throws Error{bad_file} with GDAL's reason.
DatasetPtr open_dataset(const std::filesystem::path& file, unsigned kind,
                        const std::vector<const char*>& drivers);

/// What GDAL last complained of, in one line.
std::string gdal_complaint();

/// As WKT that PROJ reads; empty if there is none.
std::string wkt_of(const OGRSpatialReference* system);

}  // namespace skycap::missions::site_data
