/// The planned photos as tables: photos.csv for people and spreadsheets, geo.txt for OpenDroneMap.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "flight/export/geodesy.h"
#include "survey/photo/photo_plan.h"

namespace skycap::missions::photos {

/// Standard deviations of the poses in which a vehicle takes planned photos.
struct PoseSigmas {
  double position = 0.1;         ///< each axis [m]
  double angle = 0.00872664626;  ///< yaw, pitch and roll [rad]
};

/// The name of a photo's image file.
std::string image_name(const survey::photo::PlannedPhoto& photo,
                       const std::string& extension = ".jpg");

/// CSV with a header: name, event (of the camera in its sortie, from 1), time_s (from take-off),
/// x, y, z (mission frame: east, north, up), latitude, longitude, ellipsoid_height, yaw_deg
/// (clockwise from north), pitch_deg (0 at the horizon, -90 straight down), roll_deg, sigma_xyz_m,
/// sigma_ypr_deg, gsd_m (at the aim; empty: none) and sortie (from 1). Without a site the three
/// geodetic columns are empty.
std::string photo_table(const survey::photo::PhotoPlan& plan,
                        const std::optional<flight::Site>& site, const PoseSigmas& sigmas = {});

/// Angles of OpenDroneMap: yaw clockwise from north; pitch 0 straight down, 90 at the horizon; the
/// top of the image points to the yaw [deg].
struct OdmAngles {
  double yaw_deg = 0.0, pitch_deg = 0.0, roll_deg = 0.0;
};
OdmAngles odm_angles(const survey::photo::PlannedPhoto& photo);

/// OpenDroneMap's image geolocation file, in EPSG:4326 with ellipsoid heights: name, longitude,
/// latitude, height, yaw, pitch, roll [deg], horizontal and vertical accuracy [m].
/// Source: OpenDroneMap documentation, "Image Geolocation Files"; compute_opk() of ODM's photo.py
/// for the angles.
std::string odm_geolocations(const survey::photo::PhotoPlan& plan, const flight::Site& site,
                             const PoseSigmas& sigmas = {});

}  // namespace skycap::missions::photos
