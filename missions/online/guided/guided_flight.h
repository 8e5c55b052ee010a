/// Flies a vehicle along legs that are given to it, and notices when something is wrong.
///
/// ArduCopter in mode GUIDED. Between two stops it is sent set points, ten a second, that move
/// along the straight leg as the vehicle can: position and velocity. Told only where to go,
/// ArduCopter would rise and sink at its own pace and leave the line. When set points cease it
/// flies on for three seconds with the velocity of the last (GUID_TIMEOUT), which is therefore
/// never more than what comes to rest before the leg's end. Nothing is sent that is not on a leg.
///
/// A leg that is given up is braked on, and counts as the vehicle's leg until it is at rest: the
/// vehicle lags behind its set points and flies past the last of them. If this program stands still
/// for longer than a second, the vehicle stops where it has flown on to, not where the set points
/// ended.
///
/// Sources: ArduPilot's ArduCopter/GCS_Mavlink.cpp, mode_guided.cpp and mode.h; MAVLink's common
/// message set.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/fly_test/flight_script.h"
#include "flight/link/autopilot_link.h"
#include "flight/motion/motion.h"
#include "flight/space/segment_distance.h"
#include "geometry/place/pose.h"
#include "missions/online/guided/aim_errors.h"
#include "missions/online/guided/flight_frame.h"
#include "missions/online/guided/gimbal_report.h"
#include "missions/online/guided/guided_limits.h"
#include "missions/online/guided/trouble.h"

namespace skycap::missions::online {

class GuidedFlight {
 public:
  /// Keeps a reference to the link. Once a stop is requested every step ends with trouble.
  GuidedFlight(flight::mavlink::AutopilotLink& link, FlightFrame frame,
               const flight::Motion& motion, const GuidedLimits& limits, std::stop_token stop);

  /// Arms and climbs straight up to a place. The vehicle must be prepared (preflight.h).
  MaybeTrouble take_off(const Eigen::Vector3d& above);

  /// Whether it has taken off from here and not landed yet.
  bool is_flying() const { return is_flying_; }

  /// Begins to turn vehicle and camera to look as at `view`.
  MaybeTrouble aim(const geometry::View& view);

  /// Flies a proven way, which begins where the vehicle holds, from stop to stop.
  MaybeTrouble fly(const std::vector<Eigen::Vector3d>& way);

  /// Waits until the vehicle is at rest and the camera looks as at `view`.
  MaybeTrouble settle(const geometry::View& view);

  /// Holds until something is done; trouble if that takes longer than `limit` [s].
  MaybeTrouble hold_until(const std::function<bool()>& is_done, double limit,
                          const Trouble& too_late);

  /// Holds until somebody takes control or nothing is heard any more, and says which.
  Trouble hold_on();

  /// Lands where it is, over `pad`.
  MaybeTrouble land(const Eigen::Vector3d& pad);

  /// From now on neither a stop nor an empty battery changes anything.
  void begin_return() { is_returning_ = true; }

  /// Below this share of the battery there is trouble.
  void need_battery(double share) { battery_needed_ = share; }

  /// From where it holds back to where the way began that it flew last.
  std::vector<Eigen::Vector3d> way_back() const { return {flown_.rbegin(), flown_.rend()}; }

  /// The way flown last is not needed to come back.
  void forget_way() { flown_ = {place_}; }

  /// Where the vehicle takes itself to be, and the camera to look.
  geometry::View view() const;
  /// Whether the gimbal was found to report its pitch against the vehicle (gimbal_report.h).
  bool reports_against_vehicle() const { return gimbal_.is_against_vehicle(); }
  std::optional<double> battery() const { return link_.state().battery(); }

 private:
  MaybeTrouble command(std::uint16_t number, const std::array<float, 7>& params,
                       const std::string& what);
  MaybeTrouble enter_mode(std::uint32_t mode, const std::string& name);
  MaybeTrouble fly_leg(const Eigen::Vector3d& to);
  MaybeTrouble watch(const flight::Segment& leg) const;
  MaybeTrouble watch_place(const flight::Segment& leg) const;
  Trouble give_up(const flight::ScriptedLeg& leg, double time, const Trouble& trouble);
  void brake(const flight::ScriptedLeg& leg, double time);
  MaybeTrouble come_to_rest(const flight::Segment& leg);
  Eigen::Vector3d stopping_place(const flight::Segment& leg) const;
  flight::SetPoint send_on(const flight::ScriptedLeg& leg, const flight::SetPoint& point);
  void listen();
  double camera_pitch() const;
  AimErrors errors_at(const geometry::View& view) const;
  void send(const flight::SetPoint& point);
  void hold_for_a_moment();
  bool is_at(const Eigen::Vector3d& place) const;
  MaybeTrouble arm_motors();
  void hold_after(const Trouble& trouble);
  Eigen::Vector3d position() const;

  flight::mavlink::AutopilotLink& link_;
  FlightFrame frame_;
  flight::Motion motion_;
  GuidedLimits limits_;
  std::stop_token stop_;
  std::uint32_t mode_ = 0;                           ///< that we have set
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();  ///< where it holds, or shall
  std::vector<Eigen::Vector3d> flown_;
  flight::Segment leg_{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  ///< flown last
  GimbalReport gimbal_;
  double yaw_ = 0.0, pitch_ = 0.0;  ///< asked for [rad]
  double battery_needed_ = 0.0;
  bool is_flying_ = false, is_returning_ = false;
};

}  // namespace skycap::missions::online
