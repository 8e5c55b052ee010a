/// Result files of a photo mission.
#pragma once

#include <filesystem>
#include <string>

#include "geometry/io/output_folder.h"
#include "missions/config/mission_setup.h"
#include "missions/photo/photo_mission.h"
#include "missions/photos/photo_table.h"

namespace skycap::missions::photo {

/// Returns the standard deviations of the poses in which the vehicle of the mission takes photos.
photos::PoseSigmas pose_sigmas(const config::MissionSetup& setup);

/// Writes the plan as a COLMAP model with known poses to `folder`, see photos::write_colmap().
void write_colmap_model(const config::MissionSetup& setup, const PhotoMission& mission,
                        const std::filesystem::path& folder);

/// Returns the text of summary.json with the section `photo`, as documented in
/// docs/reference/results.md.
std::string summary_json(const config::MissionSetup& setup, const PhotoMission& mission);

/// Stages summary.json, photos.csv, with a georeference geo.txt, and, with a vehicle, the route
/// files and free_space.bin. `skycap export` verifies routes against free_space.bin. The caller
/// commits the folder. Stores the files and their notes in `mission`.
void stage_photo_mission(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                         PhotoMission& mission, geometry::OutputFolder& folder);

}  // namespace skycap::missions::photo
