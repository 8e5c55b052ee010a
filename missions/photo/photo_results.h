/// Result files of a photo mission.
#pragma once

#include <filesystem>
#include <string>

#include "geometry/io/output_folder.h"
#include "missions/config/mission_setup.h"
#include "missions/photo/photo_mission.h"
#include "missions/photo/photo_table.h"

namespace skycap::missions::photo {

/// Returns the standard deviations of the poses in which the vehicle of the mission takes photos.
PoseSigmas pose_sigmas(const config::MissionSetup& setup);

/// Writes the plan as a COLMAP model with known poses to `folder`, see photo::write_colmap().
void write_colmap_model(const config::MissionSetup& setup, const PhotoMission& mission,
                        const std::filesystem::path& folder);

/// Returns the text of summary.json with the section `photo`, as documented in
/// docs/reference/results.md.
std::string summary_json(const config::MissionSetup& setup, const PhotoMission& mission);

/// Reads surveyed ground control points for the mission from a CSV file, see read_control_points(),
/// and adds a warning for each point that too few photos show. Throws Error{bad_file}.
void add_control_points(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                        const std::filesystem::path& file, PhotoMission& mission);

/// Estimated size of a photo as JPEG file: half a byte for each pixel.
inline constexpr double jpeg_bytes_per_pixel = 0.5;

/// Stages summary.json, photos.csv and photo_surface.csv. A georeference adds geo.txt, control
/// points add control_points.csv. A vehicle adds the route files, field_sheet.html and
/// free_space.bin. `skycap export` verifies routes against free_space.bin. The caller commits the
/// folder. Stores the files and their notes in `mission`.
void stage_photo_mission(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                         PhotoMission& mission, geometry::OutputFolder& folder);

}  // namespace skycap::missions::photo
