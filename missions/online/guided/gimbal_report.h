/// What a gimbal's report of its pitch is measured against: the horizon, or the vehicle.
///
/// GIMBAL_DEVICE_ATTITUDE_STATUS counts pitch from the horizon. ArduPilot's servo gimbals
/// (AP_Mount_Servo) report the angle of the servo, which is against the vehicle, with the same
/// flags: the report moves against the vehicle's own pitch while the camera stands still.
#pragma once

#include <cstddef>

namespace skycap::missions::online {

class GimbalReport {
 public:
  /// Another pitch is asked for [rad].
  void begin_aim(double now, double asked);

  /// A report [rad] heard at `now` [s], and the vehicle's pitch, nose up, at that time [rad].
  void hear(double now, double reported, double vehicle_pitch);

  /// Whether the reports heard so far are against the vehicle.
  bool is_against_vehicle() const { return is_against_vehicle_; }

  /// Of the camera, from the horizon [rad].
  double camera_pitch(double reported, double vehicle_pitch) const {
    return is_against_vehicle_ ? reported + vehicle_pitch : reported;
  }

 private:
  void weigh(double reported, double vehicle_pitch);

  bool is_against_vehicle_ = false;
  double begin_ = 0.0, asked_ = 0.0;
  // Of the present aim: means, and sums of squares and products about them.
  std::size_t count_ = 0;
  double mean_reported_ = 0.0, mean_vehicle_ = 0.0;
  double vehicle_squares_ = 0.0, products_ = 0.0;  ///< of all aims
  std::size_t steady_ = 0;  ///< reports in a row that are right against the vehicle alone
};

}  // namespace skycap::missions::online
