/// Plan of photos, as input of exporters, writers for photogrammetry programs, reports and the
/// photo simulator.
///
/// Mission frame: x east, y north, z up. The top of an image faces world +z
/// (geometry::camera_pose()). The top of a photo straight down faces +y (north), with yaw 0.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/pose/photo_camera.h"
#include "geometry/pose/pose.h"

namespace skycap::survey::photo {

/// Photo of the plan. Photos are in flight order.
struct PlannedPhoto {
  std::string name;          ///< File name without extension, such as "photo_0001".
  geometry::View view;       ///< Position and viewing direction.
  double yaw = 0.0;          ///< Camera heading, clockwise from north, in [0, 2 pi) [rad].
  double pitch = 0.0;        ///< 0 at the horizon, -pi/2 straight down [rad]. Roll is always 0.
  double time = 0.0;         ///< Time of exposure since the take-off of the sortie [s].
  std::uint32_t sortie = 0;  ///< Sortie of the route, counted from 0.
  double gsd = 0.0;  ///< GSD where the optical axis meets the target [m]. 0: no intersection.
  std::uint32_t observed = 0;  ///< Number of evaluation samples that it observes.
};

/// Plan of photos with the camera that takes them.
struct PhotoPlan {
  geometry::PhotoCameraConfig camera;
  double gsd = 0.0;            ///< Required GSD on a surface that faces the camera [m].
  double view_distance = 0.0;  ///< View distance d that results in this GSD [m].
  std::vector<PlannedPhoto> photos;
};

}  // namespace skycap::survey::photo
