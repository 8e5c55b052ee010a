/// Result files of a photo mission.
#pragma once

#include <string>

#include "geometry/io/output_folder.h"
#include "missions/config/mission_setup.h"
#include "missions/photo/photo_mission.h"

namespace skycap::missions::photo {

/// Returns the text of photos.csv, with a line for each photo in flight order. Positions are in the
/// mission frame (x east, y north, z up) in metres, angles in degrees. Times are since the take-off
/// of the sortie. Latitude, longitude and ellipsoid height are empty without a georeference.
std::string photos_csv(const config::MissionSetup& setup, const survey::photo::PhotoPlan& plan);

/// Returns the text of summary.json with the section `photo`, as documented in
/// docs/reference/results.md.
std::string summary_json(const config::MissionSetup& setup, const PhotoMission& mission);

/// Stages summary.json, photos.csv and, with a vehicle, the route files and free_space.bin. `skycap
/// export` verifies routes against free_space.bin. The caller commits the folder. Stores the files
/// and their notes in `mission`.
void stage_photo_mission(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                         PhotoMission& mission, geometry::OutputFolder& folder);

}  // namespace skycap::missions::photo
