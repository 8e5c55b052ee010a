/// Flies an ArduCopter in GUIDED mode along given legs and monitors it for failures.
///
/// Between two stops, position and velocity setpoints follow the straight leg at 10 Hz, within the
/// vehicle's dynamics. With position targets alone, ArduCopter would climb and descend at its own
/// rate and leave the line. When setpoints stop arriving, ArduCopter continues with the last
/// velocity for three seconds (GUID_TIMEOUT). The commanded velocity is therefore limited so that
/// the vehicle stops before the end of the leg. All setpoints are on the current leg.
///
/// To abandon a leg, the vehicle brakes along it. The leg remains the current leg until the vehicle
/// is at rest, because the vehicle lags behind its setpoints and overshoots the last one. If this
/// program stalls for more than one second, the vehicle stops at the position that it has reached
/// meanwhile.
///
/// Sources: ArduPilot's ArduCopter/GCS_Mavlink.cpp, mode_guided.cpp and mode.h; MAVLink's common
/// message set.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/segment_distance.h"
#include "flight/mavlink/autopilot_link.h"
#include "flight/monte_carlo/flight_script.h"
#include "flight/motion/motion.h"
#include "geometry/pose/pose.h"
#include "missions/online/guided/aim_errors.h"
#include "missions/online/guided/flight_failure.h"
#include "missions/online/guided/flight_frame.h"
#include "missions/online/guided/gimbal_report.h"
#include "missions/online/guided/guided_limits.h"

namespace skycap::missions::online {

/// Functions that a flight calls about ten times per second. They must not block.
struct FlightObserver {
  /// Returns whether the vehicle must hold its position. It then brakes on its leg, and continues
  /// on the same leg when this function returns false. A return is not held.
  std::function<bool()> is_held = [] { return false; };
  /// Receives the estimated vehicle position and camera direction, and the battery level (fraction
  /// of a full charge).
  std::function<void(const geometry::View&, std::optional<double>)> track =
      [](const geometry::View&, std::optional<double>) {};
  std::function<void(const std::string&)> note = [](const std::string&) {};
};

class GuidedFlight {
 public:
  /// Keeps a reference to `link`. After a stop request, every step returns a trouble.
  GuidedFlight(flight::mavlink::AutopilotLink& link, FlightFrame frame,
               const flight::Motion& motion, const GuidedLimits& limits, std::stop_token stop);

  void observe(FlightObserver observer) { observer_ = std::move(observer); }

  /// Arms the motors and climbs vertically to the position `above`. Requires a vehicle prepared by
  /// prepare() (preflight.h).
  MaybeFailure take_off(const Eigen::Vector3d& above);

  /// Returns true between take-off by this object and landing.
  bool is_flying() const { return is_flying_; }

  /// Starts to turn the vehicle and the camera to the direction of `view`.
  MaybeFailure aim(const geometry::View& view);

  /// Flies a verified path leg by leg, and holds on request of the observer. The path must start at
  /// the hold position.
  MaybeFailure fly(const std::vector<Eigen::Vector3d>& path);

  /// Waits until the vehicle is at rest and the camera is aimed in the direction of `view`.
  MaybeFailure settle(const geometry::View& view);

  /// Holds position until `is_done` returns true. Returns `too_late` after `limit` seconds.
  MaybeFailure hold_until(const std::function<bool()>& is_done, double limit,
                          const FlightFailure& too_late);

  /// Holds position while the observer requests it.
  MaybeFailure hold_on_request();

  /// Holds position until another station takes control or the link is lost. Returns the reason.
  FlightFailure hold_until_takeover();

  /// Lands at the current position, which must be above `pad`.
  MaybeFailure land(const Eigen::Vector3d& pad);

  /// Starts the return. From then on, stop requests and low battery are ignored.
  void begin_return() { is_returning_ = true; }

  /// Sets the battery level (fraction of a full charge) below which steps return a trouble.
  void need_battery(double share) { battery_needed_ = share; }

  /// Returns the path from the hold position back to the start of the last path.
  std::vector<Eigen::Vector3d> reversed_track() const {
    return {executed_path_.rbegin(), executed_path_.rend()};
  }

  /// Discards the last path when it is not required for the return.
  void clear_track() { executed_path_ = {position_}; }

  /// Returns the estimated vehicle position and camera direction.
  geometry::View view() const;
  /// Returns true if the gimbal was detected to report pitch relative to the airframe
  /// (gimbal_report.h).
  bool reports_against_vehicle() const { return gimbal_.is_against_vehicle(); }
  std::optional<double> battery() const { return link_.state().battery(); }

 private:
  MaybeFailure command(std::uint16_t number, const std::array<float, 7>& params,
                       const std::string& what);
  MaybeFailure enter_mode(std::uint32_t mode, const std::string& name);
  MaybeFailure fly_leg(const Eigen::Vector3d& to);
  bool must_hold() const { return !is_returning_ && observer_.is_held(); }
  MaybeFailure watch(const flight::Segment& leg) const;
  MaybeFailure watch_position(const flight::Segment& leg) const;
  FlightFailure abort_leg(const flight::ScriptedLeg& leg, double time,
                          const FlightFailure& failure);
  void brake(const flight::ScriptedLeg& leg, double time);
  MaybeFailure come_to_rest(const flight::Segment& leg);
  Eigen::Vector3d stopping_point(const flight::Segment& leg) const;
  flight::SetPoint send_on(const flight::ScriptedLeg& leg, const flight::SetPoint& point);
  void listen();
  double camera_pitch() const;
  bool has_fixed_camera() const;
  AimErrors errors_at(const geometry::View& view) const;
  void send(const flight::SetPoint& point);
  void hold_briefly();
  bool is_at(const Eigen::Vector3d& location) const;
  MaybeFailure arm_motors();
  void hold_after(const FlightFailure& failure);
  Eigen::Vector3d position() const;

  flight::mavlink::AutopilotLink& link_;
  FlightFrame frame_;
  flight::Motion motion_;
  GuidedLimits limits_;
  std::stop_token stop_;
  FlightObserver observer_;
  std::uint32_t mode_ = 0;                              ///< Last flight mode set by this program.
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();  ///< Current or next hold position.
  std::vector<Eigen::Vector3d> executed_path_;
  flight::Segment leg_{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  ///< Last flown leg.
  GimbalReport gimbal_;
  double yaw_ = 0.0, pitch_ = 0.0;  ///< Commanded heading and camera pitch [rad].
  double battery_needed_ = 0.0;
  bool is_flying_ = false, is_returning_ = false;
};

}  // namespace skycap::missions::online
