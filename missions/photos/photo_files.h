/// Tables of planned photos for people and for photogrammetry programs.
#pragma once

#include <optional>
#include <string>

#include "geometry/io/output_folder.h"
#include "missions/photos/photo_table.h"

namespace skycap::missions::photos {

inline constexpr const char* photo_table_name = "photos.csv";
inline constexpr const char* odm_file_name = "geo.txt";
inline constexpr const char* colmap_folder_name = "colmap";

/// Stages photos.csv, and geo.txt if the mission has a site.
void stage_photo_tables(const survey::photo::PhotoPlan& plan,
                        const std::optional<flight::Site>& site, const PoseSigmas& sigmas,
                        geometry::OutputFolder& folder);

}  // namespace skycap::missions::photos
