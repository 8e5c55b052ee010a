/// The results of a photo mission on disk.
#pragma once

#include <string>

#include "geometry/io/output_folder.h"
#include "missions/config/mission_setup.h"
#include "missions/photo/photo_mission.h"

namespace skycap::missions::photo {

/// photos.csv: a line for each photo in the order of the flight. Mission frame (x east, y north, z
/// up) in metres, angles in degrees, times since the take-off of the sortie; latitude, longitude
/// and ellipsoid height are empty without a georeference.
std::string photos_csv(const config::MissionSetup& setup, const survey::photo::PhotoPlan& plan);

/// summary.json with the section `photo`, as docs/reference/results.md describes it.
std::string summary_json(const config::MissionSetup& setup, const PhotoMission& mission);

/// Stages summary.json, photos.csv and, with a vehicle, the route files and free_space.bin, in
/// which they are verified again by skycap export; the caller commits. Files and their notes are
/// kept in `mission`.
void stage_photo_mission(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                         PhotoMission& mission, geometry::OutputFolder& folder);

}  // namespace skycap::missions::photo
