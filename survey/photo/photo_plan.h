/// A finished plan of photographs: what exporters, writers for photogrammetry programs, reports and
/// the simulator of photos take.
///
/// Mission frame: x east, y north, z up. A photo's image has its top towards world +z
/// (geometry::camera_pose()); a photo straight down has it towards +y (north), and yaw 0.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/pose/photo_camera.h"
#include "geometry/pose/pose.h"

namespace skycap::survey::photo {

/// A photo of the plan, in the order of its flight.
struct PlannedPhoto {
  std::string name;            ///< file name without ending, such as "photo_0001"
  geometry::View view;         ///< position and viewing direction
  double yaw = 0.0;            ///< heading of the camera, clockwise from north, in [0, 2 pi) [rad]
  double pitch = 0.0;          ///< 0 at the horizon, -pi/2 straight down [rad]; roll is always 0
  double time = 0.0;           ///< of the exposure, since the take-off of its sortie [s]
  std::uint32_t sortie = 0;    ///< of the route, counted from 0
  double gsd = 0.0;            ///< where the optical axis meets the target [m]; 0: it does not
  std::uint32_t observed = 0;  ///< samples of the evaluation set that it observes
};

/// A plan of photos with the camera that takes them.
struct PhotoPlan {
  geometry::PhotoCameraConfig camera;
  double gsd = 0.0;            ///< that was asked for, on the surface, head-on [m]
  double view_distance = 0.0;  ///< d, at which a surface that faces the camera has it [m]
  std::vector<PlannedPhoto> photos;
};

}  // namespace skycap::survey::photo
