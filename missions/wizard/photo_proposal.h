/// Proposes the camera, quality and limits of a photo mission.
#pragma once

#include <string>

#include "flight/motion/vehicle.h"

namespace skycap::missions::wizard {

/// Proposed values of a photo mission.
struct PhotoValues {
  std::string camera;          ///< Preset or file, as in sensor.photo_camera.
  std::string camera_name;     ///< Name in the description.
  double gsd = 0.0;            ///< photo.gsd [m].
  bool is_coarse = false;      ///< First flight of two (photo.pass).
  bool has_poses = true;       ///< The vehicle measures its position precisely (photo.poses).
  double view_distance = 0.0;  ///< Distance that results in the planned sampling distance [m].
  double stand_off = 0.0;      ///< Minimum distance of a photo from any surface [m].
};

/// True if the name is that of a photo camera preset.
bool is_photo_camera(const std::string& sensor);

/// Returns the vehicle preset that carries a photo camera preset: the one with a camera of the same
/// model, m350_rtk for Zenmuse cameras, otherwise "generic".
std::string find_photo_vehicle(const std::string& camera);

/// Returns the values for a camera (preset or file) and a ground sampling distance [m]. `clearance`
/// is that of the flight and `uncertainty` that of the target's position [m]. On a coarse pass, the
/// sampling distance is three times as large. Throws Error{bad_config} if the view distance is less
/// than the stand-off, and the errors of config::find_photo_camera().
PhotoValues propose_photos(const std::string& camera, double gsd, const flight::Vehicle& vehicle,
                           double clearance, double uncertainty, bool is_coarse);

/// Returns the sections `sensor`, `photo` and `limits` of a mission file. `camera` is the text of
/// the value of sensor.photo_camera.
std::string photo_sections(const PhotoValues& values, const std::string& camera);

}  // namespace skycap::missions::wizard
