/// A multicopter under its autopilot's position control: where it is, not how it is tilted.
///
/// The cascade that ArduCopter and PX4 share: the velocity that is wanted is the set point's and a
/// share of the position error; the acceleration, the set point's and a share of the velocity error
/// and of its sum. The airframe follows with a lag, within the tilt that autopilots allow, and the
/// air pulls at it. Gains and lag are rounded from the autopilots' defaults (PSC_*, MPC_*).
#pragma once

#include <Eigen/Core>

#include "flight/motion/motion.h"

namespace skycap::flight {

/// Where the vehicle shall be now.
struct SetPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

class VehicleModel {
 public:
  /// At rest. Keeps a reference.
  VehicleModel(const Motion& motion, const Eigen::Vector3d& position)
      : motion_(motion), position_(position) {}

  /// Flies on for `step` [s]; `error` is how far it takes itself to be off (believed less true
  /// position), `air` the velocity of the air.
  void fly(const SetPoint& wanted, const Eigen::Vector3d& error, const Eigen::Vector3d& air,
           double step);

  const Eigen::Vector3d& position() const { return position_; }
  const Eigen::Vector3d& velocity() const { return velocity_; }
  double energy() const { return energy_; }  ///< used so far [J]

 private:
  Eigen::Vector3d drag(const Eigen::Vector3d& air) const;  ///< as an acceleration

  const Motion& motion_;
  Eigen::Vector3d position_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d thrust_ = Eigen::Vector3d::Zero();  ///< acceleration beyond holding its weight
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();     ///< of the velocity's error, as acceleration
  double energy_ = 0.0;
};

}  // namespace skycap::flight
