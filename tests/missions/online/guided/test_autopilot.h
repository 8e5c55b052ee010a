/// An autopilot that speaks MAVLink as ArduCopter does, flies the simulated vehicle of fly-test,
/// and has what faults a test wants. Its time is what it is told to fly on.
///
/// With a jerk it follows set points as ArduCopter does: they are shaped by limits of acceleration
/// and jerk, so that the vehicle lags behind them and flies past the last of them
/// (AC_PosControl::input_pos_vel_accel_xy; AP_Math/control.cpp, shape_pos_vel_accel).
#pragma once

#include <cstdint>
#include <functional>
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

/// Times are since the vehicle took off [s]; none: never.
struct Faults {
  double lost = 0.0, doubled = 0.0, damaged = 0.0, late = 0.0;  ///< shares of frames, both ways
  std::optional<double> silent = {};                            ///< from then on
  std::optional<double> position_stops = {};                    ///< from then on
  std::optional<double> estimate_lost = {};
  std::optional<double> pilot_takes_over = {};  ///< mode LOITER
  std::optional<double> blown_away = {};        ///< half a metre a second to the east
  std::optional<double> battery_fails = {};     ///< it is nearly empty at once
  double battery = 1.0;                         ///< share at the beginning
  std::optional<double> jerk = {};              ///< of the shaped set points [m/s^3]
  double drift = 0.0;                           ///< about the set points: amplitude [m]
  double wind_pitch = 0.0;                      ///< that it leans against the wind with [rad]
  bool gimbal_against_vehicle = false;          ///< what its gimbal reports, as servo gimbals do
  bool gimbal_stuck = false;                    ///< at the horizon
  bool has_no_gimbal = false;                   ///< as ArduCopter comes: MNT1_TYPE is 0
  bool answers_parameters = true;
  float guided_timeout = 3.0F;  ///< its parameter GUID_TIMEOUT [s]
  bool rejects_arming = false;
  bool is_armed = false;
  std::uint8_t autopilot = 3;
  Eigen::Vector3d pad_offset = Eigen::Vector3d::Zero();
};

class TestAutopilot {
 public:
  TestAutopilot(const flight::FlightOptions& flight, const Eigen::Vector3d& pad,
                const Faults& faults);

  /// Takes in what was sent to it.
  void hear(std::span<const std::uint8_t> bytes);

  /// Flies on; what it says meanwhile.
  flight::mavlink::Bytes fly_on(double duration);

  double time() const { return time_; }
  double taken_off() const { return taken_off_.value(); }  ///< when
  bool has_taken_off() const { return taken_off_.has_value(); }
  bool is_armed() const { return is_armed_; }
  bool has_landed() const { return taken_off_ && !is_armed_; }
  std::uint32_t mode() const { return mode_; }
  const Eigen::Vector3d& position() const { return vehicle_.position(); }
  /// Where it was, 25 times a second.
  const std::vector<Eigen::Vector3d>& track() const { return track_; }
  /// The set points that it was sent, in the mission's frame.
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

  Faults faults_;
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

/// A link to it whose time is the autopilot's: it passes while one waits.
class SteppedPort : public flight::mavlink::Port {
 public:
  explicit SteppedPort(TestAutopilot& autopilot) : autopilot_(autopilot) {}

  void send(std::span<const std::uint8_t> bytes) override { autopilot_.hear(bytes); }
  flight::mavlink::Bytes receive(double patience) override { return autopilot_.fly_on(patience); }
  double now() const override { return autopilot_.time(); }

 private:
  TestAutopilot& autopilot_;
};

/// The same, and from a moment on nothing is heard or sent for a while, as if the program that uses
/// it had stood still; what was said meanwhile comes at once.
class StallingPort : public SteppedPort {
 public:
  /// Both since the vehicle took off [s].
  StallingPort(TestAutopilot& autopilot, double begin, double duration)
      : SteppedPort(autopilot), autopilot_(autopilot), begin_(begin), duration_(duration) {}

  flight::mavlink::Bytes receive(double patience) override;

  /// Where the vehicle was when the program went on.
  const std::optional<Eigen::Vector3d>& woken_at() const { return woken_at_; }

 private:
  TestAutopilot& autopilot_;
  double begin_, duration_;
  std::optional<Eigen::Vector3d> woken_at_;
};

/// Has it fly by the clock of a port, over which it speaks and hears, until `is_over`.
void fly_in_real_time(TestAutopilot& autopilot, flight::mavlink::Port& port,
                      const std::function<bool()>& is_over);

}  // namespace skycap::missions::online
