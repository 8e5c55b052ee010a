/// Autopilot with ArduCopter's MAVLink interface for `fly --connect simulated` and for tests. It
/// flies the simulated vehicle of fly-test, with the faults that a test selects. Its time advances
/// only through calls.
///
/// With a jerk limit, it follows setpoints as ArduCopter does. Limits of acceleration and jerk
/// shape the setpoints, so the vehicle lags behind them and overshoots the last one
/// (AC_PosControl::input_pos_vel_accel_xy; AP_Math/control.cpp, shape_pos_vel_accel).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/flight_options.h"
#include "flight/mavlink/guided_messages.h"
#include "flight/mavlink/port.h"
#include "flight/monte_carlo/flight_script.h"
#include "flight/monte_carlo/vehicle_model.h"
#include "missions/online/guided/flight_frame.h"

namespace skycap::missions::online {

/// Faults for tests. Times are relative to the take-off [s]; empty: the fault does not occur.
struct AutopilotFaults {
  /// Fractions of frames, in both directions.
  double lost = 0.0, doubled = 0.0, damaged = 0.0, late = 0.0;
  /// Time after which nothing is sent.
  std::optional<double> silent = {};
  /// Time after which the position is not updated.
  std::optional<double> position_stops = {};
  std::optional<double> estimate_lost = {};
  std::optional<double> pilot_takes_over = {};  ///< time at which the mode changes to LOITER
  /// Time after which the vehicle drifts to the east at 0.5 m/s.
  std::optional<double> blown_away = {};
  std::optional<double> battery_fails = {};  ///< time at which the battery becomes nearly empty
  double battery = 1.0;                      ///< initial charge, as a fraction
  std::optional<double> jerk = {};           ///< jerk limit of the shaped setpoints [m/s^3]
  /// Amplitude of the drift around the setpoints [m].
  double drift = 0.0;
  double wind_pitch = 0.0;  ///< constant pitch against the wind [rad]
  /// Gimbal reports angles relative to the vehicle, like servo gimbals.
  bool gimbal_against_vehicle = false;
  bool gimbal_stuck = false;   ///< gimbal stays at the horizon
  bool has_no_gimbal = false;  ///< ArduCopter's default: MNT1_TYPE is 0
  bool answers_parameters = true;
  float guided_timeout = 3.0F;  ///< parameter GUID_TIMEOUT [s]
  bool rejects_arming = false;
  bool is_armed = false;
  std::uint8_t autopilot = 3;
  Eigen::Vector3d pad_offset = Eigen::Vector3d::Zero();
};

class SimulatedAutopilot {
 public:
  SimulatedAutopilot(const flight::FlightOptions& flight, const Eigen::Vector3d& pad,
                     const AutopilotFaults& faults);

  /// Processes received bytes.
  void hear(std::span<const std::uint8_t> bytes);

  /// Advances the flight by `duration` [s] and returns the bytes sent meanwhile.
  flight::mavlink::Bytes fly_on(double duration);

  void take_over();  ///< A pilot selects the mode LOITER.

  double time() const { return time_; }
  double taken_off() const { return taken_off_.value(); }  ///< time of the take-off
  bool has_taken_off() const { return taken_off_.has_value(); }
  bool is_armed() const { return is_armed_; }
  bool has_landed() const { return taken_off_ && !is_armed_; }
  std::uint32_t mode() const { return mode_; }
  const Eigen::Vector3d& position() const { return vehicle_.position(); }
  /// Returns the positions of the vehicle at 25 Hz.
  const std::vector<Eigen::Vector3d>& track() const { return track_; }
  /// Returns the received setpoints in the mission frame.
  const std::vector<Eigen::Vector3d>& set_points() const { return set_points_; }

 private:
  void step();
  flight::SetPoint target_point();
  flight::SetPoint shaped(const flight::SetPoint& target_point);
  double vehicle_pitch() const;
  void obey(const flight::mavlink::CommandLong& command);
  void tell(const flight::mavlink::ParameterRequest& request);
  void aim_at(const flight::mavlink::PositionTarget& target);
  void speak();
  bool is_past(const std::optional<double>& moment) const;
  template <class M>
  void send_frame(const M& message);

  AutopilotFaults faults_;
  FlightFrame frame_;
  flight::Motion motion_;
  flight::VehicleModel vehicle_;
  Eigen::Vector3d pad_;
  flight::mavlink::FrameReader reader_{flight::mavlink::guided_extra_byte};
  std::mt19937_64 random_{1};
  flight::mavlink::Bytes outgoing_, late_;
  std::uint8_t sequence_ = 0;
  double time_ = 0.0, next_words_ = 0.0;
  std::uint64_t words_ = 0;
  std::optional<double> taken_off_;
  std::optional<flight::ScriptedLeg> climb_;
  std::optional<flight::SetPoint> shaped_;
  Eigen::Vector3d acceleration_ = Eigen::Vector3d::Zero();
  bool is_armed_ = false;
  std::uint32_t mode_ = 0;
  flight::SetPoint target_;
  double target_time_ = 0.0, yaw_ = 0.0, pitch_ = 0.0, target_yaw_ = 0.0, target_pitch_ = 0.0;
  std::vector<Eigen::Vector3d> track_, set_points_;
};

/// Link in the autopilot's time, which advances while the caller waits.
class SteppedPort : public flight::mavlink::Port {
 public:
  explicit SteppedPort(SimulatedAutopilot& autopilot) : autopilot_(autopilot) {}

  void send(std::span<const std::uint8_t> bytes) override { autopilot_.hear(bytes); }
  flight::mavlink::Bytes receive(double patience) override { return autopilot_.fly_on(patience); }
  double now() const override { return autopilot_.time(); }

 private:
  SimulatedAutopilot& autopilot_;
};

/// Returns a link to an autopilot that starts on `pad`, without faults and wind.
std::unique_ptr<flight::mavlink::Port> make_simulated_port(const flight::FlightOptions& flight,
                                                           const Eigen::Vector3d& pad);

}  // namespace skycap::missions::online
