/// Additional files of a mission with a photo camera, and the camera data for its flight.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "flight/motion/photo_speed.h"
#include "geometry/io/output_folder.h"
#include "missions/photos/colmap_model.h"
#include "missions/photos/photo_table.h"

namespace skycap::missions::photos {

/// Returns the payloadEnumValue of DJI's WPML for a camera preset such as "zenmuse_p1_35", or
/// nullopt for cameras of other makers. Source: DJI Cloud API documentation, "Product Support" and
/// "Common Elements".
std::optional<int> wpml_payload(std::string_view camera);

/// Returns the camera data that the flight depends on, for photos with ground sampling distance
/// `gsd` [m].
flight::PhotoShutter make_photo_shutter(const geometry::PhotoCameraConfig& camera, double gsd);

inline constexpr const char* photo_table_name = "photos.csv";
inline constexpr const char* odm_file_name = "geo.txt";
inline constexpr const char* colmap_folder_name = "colmap";

/// Stages photos.csv, and geo.txt if the mission has a site.
void stage_photo_tables(const survey::photo::PhotoPlan& plan,
                        const std::optional<flight::Site>& site, const PoseSigmas& sigmas,
                        geometry::OutputFolder& folder);

}  // namespace skycap::missions::photos
