/// Multicopter under position control. Models the position, not the attitude.
///
/// The control cascade is the one common to ArduCopter and PX4. The desired velocity is that of the
/// setpoint plus a fraction of the position error. The desired acceleration is that of the setpoint
/// plus fractions of the velocity error and of its integral. The airframe follows with a lag within
/// the tilt limits, and with drag. Gains and lag are rounded from the autopilots' defaults (PSC_*,
/// MPC_*).
#pragma once

#include <Eigen/Core>

#include "flight/motion/motion.h"

namespace skycap::flight {

/// Desired state.
struct SetPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

class VehicleModel {
 public:
  /// Starts at rest. Keeps a reference to `motion`.
  VehicleModel(const Motion& motion, const Eigen::Vector3d& position)
      : motion_(motion), position_(position) {}

  /// Advances the simulation by `step` [s]. `error` is the navigation error, estimated minus true
  /// position [m]. `air` is the air velocity [m/s].
  void fly(const SetPoint& target, const Eigen::Vector3d& error, const Eigen::Vector3d& air,
           double step);

  const Eigen::Vector3d& position() const { return position_; }
  const Eigen::Vector3d& velocity() const { return velocity_; }
  double energy() const { return energy_; }  ///< Energy used so far [J].

 private:
  Eigen::Vector3d drag(const Eigen::Vector3d& air) const;  ///< Drag as acceleration [m/s^2].

  const Motion& motion_;
  Eigen::Vector3d position_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  /// Acceleration in addition to gravity compensation [m/s^2].
  Eigen::Vector3d thrust_ = Eigen::Vector3d::Zero();
  /// Integral of the velocity error, as acceleration [m/s^2].
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  double energy_ = 0.0;
};

}  // namespace skycap::flight
