/// Maximum speed of a vehicle while its photo camera takes photos in flight.
#pragma once

#include <string>

namespace skycap::flight {

/// Properties of a photo camera that the flight depends on.
struct PhotoShutter {
  double gsd = 0.0;         ///< Ground sampling distance on a surface that faces the camera [m].
  double exposure = 0.001;  ///< Exposure time of each pixel [s].
  double readout = 0.0;  ///< Readout time of a rolling shutter from first to last row [s]. Zero: no
                         ///< rolling shutter.
  double min_interval = 1.0;  ///< Minimum time between two photos [s].
  /// Type of the stored image, as spelled in DJI's WPML: "visable", "wide", "zoom".
  std::string image_format = "visable";
  int payload = 0;  ///< payloadEnumValue of DJI's WPML. 0: value of the vehicle.

  /// Throws Error{bad_config} with the name of the first field outside its interval.
  void validate() const;
};

/// Upper limits of the ground speed [m/s]. Infinite without a limit.
struct PhotoSpeeds {
  double blur = 0.0;  ///< Speed with a motion blur of half a ground sampling distance.
  double rolling_shutter =
      0.0;  ///< Speed with a skew of one ground sampling distance from first to last row.
  double trigger = 0.0;  ///< Speed at which the time between photos is min_interval.
  double vehicle = 0.0;  ///< Speed limit of the vehicle and the mission.

  double min() const;
  /// Returns the name of the smallest limit for messages: "motion blur", "rolling shutter",
  /// "trigger interval" or "cruise speed".
  const char* limit() const;
};

/// Returns the limits for photos at a distance of `spacing` [m] and a vehicle speed of at most
/// `vehicle_speed` [m/s].
PhotoSpeeds photo_speeds(const PhotoShutter& shutter, double spacing, double vehicle_speed);

}  // namespace skycap::flight
