/// How fast a vehicle may fly while its photo camera takes photos without a stop.
#pragma once

#include <string>

namespace skycap::flight {

/// A photo camera as far as the flight depends on it.
struct PhotoShutter {
  double gsd = 0.0;           ///< ground sampling distance on the surface, head-on [m]
  double exposure = 0.001;    ///< of each pixel [s]
  double readout = 0.0;       ///< of a rolling shutter, first to last row [s]; zero: none
  double min_interval = 1.0;  ///< between two photos [s]
  /// Kind of image that is stored, as DJI's WPML spells it: "visable", "wide", "zoom".
  std::string image_format = "visable";
  int payload = 0;  ///< payloadEnumValue of DJI's WPML; 0: that of the vehicle

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

/// Upper limits of the speed over ground [m/s]; infinite where nothing limits it.
struct PhotoSpeeds {
  double blur = 0.0;             ///< motion blur of half a ground sampling distance
  double rolling_shutter = 0.0;  ///< skew of one ground sampling distance, first to last row
  double trigger = 0.0;          ///< the next photo is min_interval later
  double vehicle = 0.0;          ///< of the vehicle and the mission

  double min() const;
  /// Name of the smallest limit, for messages: "motion blur", "rolling shutter", "trigger interval"
  /// or "cruise speed".
  const char* limit() const;
};

/// The limits for photos that are `spacing` apart [m], with a vehicle that flies at most
/// `vehicle_speed` [m/s].
PhotoSpeeds photo_speeds(const PhotoShutter& shutter, double spacing, double vehicle_speed);

}  // namespace skycap::flight
