/// Detection of the reference of reported gimbal pitch angles: horizon or airframe.
///
/// GIMBAL_DEVICE_ATTITUDE_STATUS defines pitch relative to the horizon. ArduPilot's servo gimbals
/// (AP_Mount_Servo) report the servo angle, which is relative to the airframe, with the same flags.
/// The reported angle then varies with the vehicle's pitch although the camera direction is
/// constant.
#pragma once

#include <cstddef>

namespace skycap::missions::online {

class GimbalReport {
 public:
  /// Starts a new aim with commanded camera pitch `asked` [rad] at time `now` [s].
  void begin_aim(double now, double asked);

  /// Processes a pitch report [rad] received at `now` [s] together with the vehicle's pitch,
  /// positive nose up, at that time [rad].
  void hear(double now, double reported, double vehicle_pitch);

  /// Returns true once the reports indicate angles relative to the airframe.
  bool is_against_vehicle() const { return is_against_vehicle_; }

  /// Returns the camera pitch relative to the horizon [rad].
  double camera_pitch(double reported, double vehicle_pitch) const {
    return is_against_vehicle_ ? reported + vehicle_pitch : reported;
  }

 private:
  void weigh(double reported, double vehicle_pitch);

  bool is_against_vehicle_ = false;
  double begin_ = 0.0, asked_ = 0.0;
  // Means of the current aim.
  std::size_t count_ = 0;
  double mean_reported_ = 0.0, mean_vehicle_ = 0.0;
  /// Sums of squares and products about the means, over all aims.
  double vehicle_squares_ = 0.0, products_ = 0.0;
  /// Consecutive reports that match the commanded pitch only as airframe-relative angles.
  std::size_t steady_ = 0;
};

}  // namespace skycap::missions::online
