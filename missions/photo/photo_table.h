/// Tables of the planned photos: photos.csv for users and spreadsheets, geo.txt for OpenDroneMap.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "flight/export/geodesy.h"
#include "geometry/io/output_folder.h"
#include "survey/photo/photo_plan.h"

namespace skycap::missions::photo {

inline constexpr const char* photo_table_name = "photos.csv";
inline constexpr const char* odm_file_name = "geo.txt";

/// Standard deviations of the photo poses achieved by a vehicle.
struct PoseSigmas {
  double position = 0.1;         ///< Position error in each axis [m].
  double angle = 0.00872664626;  ///< Error of yaw, pitch and roll [rad].
};

/// Returns the file name of a photo.
std::string image_name(const survey::photo::PlannedPhoto& photo,
                       const std::string& extension = ".jpg");

/// Returns a CSV table with a header. Columns: name, event (number of the photo in its sortie, from
/// 1), time_s (from take-off), x, y, z (mission frame: east, north, up), latitude, longitude,
/// ellipsoid_height, yaw_deg (clockwise from north), pitch_deg (0 at the horizon, -90 straight
/// down), roll_deg, sigma_xyz_m, sigma_ypr_deg, gsd_m (on the optical axis; empty without
/// intersection) and sortie (from 1). Without a site, the three geodetic columns are empty.
std::string photo_table(const survey::photo::PhotoPlan& plan,
                        const std::optional<flight::Site>& site, const PoseSigmas& sigmas = {});

/// Angles in OpenDroneMap's convention [deg]. Yaw is clockwise from north. Pitch is 0 straight down
/// and 90 at the horizon. The top of the image points in the direction of the yaw.
struct OdmAngles {
  double yaw_deg = 0.0, pitch_deg = 0.0, roll_deg = 0.0;
};
OdmAngles odm_angles(const survey::photo::PlannedPhoto& photo);

/// Returns OpenDroneMap's image geolocation file in EPSG:4326 with ellipsoid heights. Columns:
/// name, longitude, latitude, height, yaw, pitch, roll [deg], horizontal and vertical accuracy [m].
/// Sources: OpenDroneMap documentation, "Image Geolocation Files"; for the angles, compute_opk() in
/// ODM's photo.py.
std::string odm_geolocations(const survey::photo::PhotoPlan& plan, const flight::Site& site,
                             const PoseSigmas& sigmas = {});

/// Stages photos.csv, and geo.txt if the mission has a site.
void stage_photo_tables(const survey::photo::PhotoPlan& plan,
                        const std::optional<flight::Site>& site, const PoseSigmas& sigmas,
                        geometry::OutputFolder& folder);

}  // namespace skycap::missions::photo
