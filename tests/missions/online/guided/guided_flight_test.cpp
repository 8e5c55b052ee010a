// A vehicle guided along legs by an autopilot that follows setpoints as ArduCopter does: it lags
// behind them, overshoots the last one, drifts, and may be stopped at any time.
#include "missions/online/guided/guided_flight.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/clearance/segment_distance.h"
#include "missions/config/resolve.h"
#include "missions/online/guided/preflight.h"
#include "missions/online/guided/simulated_autopilot.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/not_empty.h"

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

const Vector3d pad(-75, 0, 0);

const flight::FlightOptions& options() {
  static const flight::FlightOptions options = [] {
    std::string text = tests::flight_mission();
    const std::string vehicle = "vehicle: generic";
    text.insert(text.find(vehicle) + vehicle.size(), "_ardupilot");
    return config::parse_mission(text, "m.yaml").flight();
  }();
  return options;
}

/// Returns a path with four stops. The first point is above the pad.
const std::vector<Vector3d>& path() {
  static const std::vector<Vector3d> positions = {
      {-75, 0, 8}, {-45, 0, 8}, {-45, 25, 14}, {-15, 25, 14}, {-15, 25, 30}};
  return positions;
}

/// Jerk limits of ArduCopter's guided mode (PSC_JERK_XY) and of a vehicle that tilts more slowly
/// [m/s^3].
constexpr double default_jerk = 5.0, heavy_jerk = 2.0;

/// Port that calls an observer at each time step.
class WatchedPort : public SteppedPort {
 public:
  WatchedPort(SimulatedAutopilot& autopilot, std::function<void()> observer)
      : SteppedPort(autopilot), observer_(std::move(observer)) {}

  flight::mavlink::Bytes receive(double patience) override {
    observer_();
    return SteppedPort::receive(patience);
  }

 private:
  std::function<void()> observer_;
};

/// Stepped port that pauses for a while, as if the program that uses it had been suspended.
/// Messages of that time then arrive at once.
class StallingPort : public SteppedPort {
 public:
  /// Both times are relative to the take-off [s].
  StallingPort(SimulatedAutopilot& autopilot, double begin, double duration)
      : SteppedPort(autopilot), autopilot_(autopilot), begin_(begin), duration_(duration) {}

  flight::mavlink::Bytes receive(double patience) override {
    const bool is_due = !woken_at_ && autopilot_.has_taken_off() &&
                        autopilot_.time() - autopilot_.taken_off() >= begin_;
    if (!is_due) return SteppedPort::receive(patience);
    flight::mavlink::Bytes heard = SteppedPort::receive(duration_);
    woken_at_ = autopilot_.position();
    return heard;
  }

  /// Returns the position of the vehicle at the end of the pause.
  const std::optional<Eigen::Vector3d>& woken_at() const { return woken_at_; }

 private:
  SimulatedAutopilot& autopilot_;
  double begin_, duration_;
  std::optional<Eigen::Vector3d> woken_at_;
};

struct Flight {
  explicit Flight(const AutopilotFaults& faults) : autopilot(options(), pad, faults) {}

  /// Takes off and flies the path. Returns the reason if it ended early.
  MaybeFailure fly(flight::mavlink::Port& port, std::stop_token stop) {
    const flight::GeodeticPoint origin = options().site.origin;
    link = std::make_unique<flight::mavlink::AutopilotLink>(port);
    if (MaybeFailure failure = prepare(*link, {origin, pad}, pad, motion.vehicle(), limits, stop)) {
      return failure;
    }
    vehicle = std::make_unique<GuidedFlight>(*link, FlightFrame(origin, pad), motion, limits, stop);
    if (MaybeFailure failure = vehicle->take_off(path().front())) return failure;
    has_climbed = true;
    return vehicle->fly(path());
  }

  /// Returns as a live flight does: back along the flown path, then down.
  MaybeFailure return_to_home() {
    vehicle->begin_return();
    if (MaybeFailure failure = vehicle->fly(vehicle->reversed_track())) return failure;
    return vehicle->land(pad);
  }

  double cross_track_error(const Vector3d& position) const {
    double nearest = (position - pad).norm();
    Vector3d from = pad;
    for (const Vector3d& to : path()) {
      nearest = std::min(
          nearest,
          std::sqrt(flight::nearest(flight::Segment{from, to}, position).squared_distance));
      from = to;
    }
    return nearest;
  }

  double farthest_off() const {
    double farthest = 0.0;
    for (const Vector3d& position : autopilot.track()) {
      farthest = std::max(farthest, cross_track_error(position));
    }
    return farthest;
  }

  const flight::Motion motion{options().required_vehicle(), options().route(pad).conditions};
  GuidedLimits limits{.corridor = 1.3, .arrival = 0.3};
  SimulatedAutopilot autopilot;
  std::unique_ptr<flight::mavlink::AutopilotLink> link;
  std::unique_ptr<GuidedFlight> vehicle;
  bool has_climbed = false;
};

/// Returns the duration of the whole path and back without an interruption, and checks that it is
/// flown.
double whole_time(const AutopilotFaults& faults) {
  Flight flight(faults);
  SteppedPort port(flight.autopilot);
  const MaybeFailure failure = flight.fly(port, {});
  EXPECT_FALSE(failure) << failure->what;
  return flight.autopilot.time() - flight.autopilot.taken_off();
}

// At the end of braking, the vehicle is ahead of its setpoint by more than the tolerance of
// verified legs.
TEST(GuidedFlight, OvershootsSetPointsOnTestAutopilot) {
  Flight flight({.jerk = heavy_jerk});
  std::stop_source stop;
  double max = 0.0;
  WatchedPort port(flight.autopilot, [&] {
    if (flight.autopilot.has_taken_off() &&
        flight.autopilot.time() - flight.autopilot.taken_off() > 13.0) {
      stop.request_stop();
    }
    const auto& sent = flight.autopilot.set_points();
    if (!stop.stop_requested() || sent.empty()) return;
    max = std::max(max, (flight.autopilot.position() - sent.back()).norm());
  });
  ASSERT_TRUE(flight.fly(port, stop.get_token()));
  EXPECT_GT(max, 1.3);
}

struct Kind {
  const char* name;
  AutopilotFaults faults;
};

class Interruptions : public testing::TestWithParam<Kind> {};

INSTANTIATE_TEST_SUITE_P(
    GuidedFlight, Interruptions,
    testing::Values(Kind{"exact", {}}, Kind{"default_jerk", {.jerk = default_jerk}},
                    Kind{"heavy", {.jerk = heavy_jerk}},
                    Kind{"heavy_and_drifting", {.jerk = heavy_jerk, .drift = 0.1}}),
    [](const auto& test) { return std::string(test.param.name); });

// Two hundred interruptions at random moments. All flights return along their path and land.
TEST_P(Interruptions, EndOnPad) {
  const double whole = whole_time(GetParam().faults);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> moments(0.5, whole);
  for (int i = 0; i < 200; ++i) {
    const double moment = moments(random);
    Flight flight(GetParam().faults);
    std::stop_source stop;
    WatchedPort port(flight.autopilot, [&] {
      if (flight.autopilot.has_taken_off() &&
          flight.autopilot.time() - flight.autopilot.taken_off() >= moment) {
        stop.request_stop();
      }
    });
    const MaybeFailure failure = flight.fly(port, stop.get_token());
    if (!failure) continue;  // the moment is after the last leg
    ASSERT_EQ(failure->kind, FailureKind::interrupted)
        << "after " << moment << " s: " << failure->what;
    const MaybeFailure returned = flight.return_to_home();
    ASSERT_FALSE(returned) << "after " << moment << " s: " << returned->what;
    EXPECT_FALSE(flight.autopilot.is_armed());
    EXPECT_LT((flight.autopilot.position() - pad).norm(), 0.6) << "after " << moment << " s";
    EXPECT_LT(flight.farthest_off(), flight.limits.corridor) << "after " << moment << " s";
  }
}

// The vehicle holds on the leg on which it was interrupted, and is at rest there.
TEST(GuidedFlight, HoldsAtRestOnLegWhenInterrupted) {
  for (const double moment : {9.0, 12.0, 15.0, 21.0, 27.0, 33.0}) {
    Flight flight({.jerk = heavy_jerk});
    std::stop_source stop;
    WatchedPort port(flight.autopilot, [&] {
      if (flight.autopilot.has_taken_off() &&
          flight.autopilot.time() - flight.autopilot.taken_off() >= moment) {
        stop.request_stop();
      }
    });
    ASSERT_TRUE(flight.fly(port, stop.get_token()));
    const Vector3d& position = flight.autopilot.position();
    EXPECT_LT((position - flight.autopilot.set_points().back()).norm(),
              flight.limits.arrival + 0.02);
    EXPECT_LT(flight.cross_track_error(position), flight.limits.arrival + 0.02);
  }
}

struct Stall {
  double begin, duration;
};

class Stalls : public testing::TestWithParam<Stall> {};

INSTANTIATE_TEST_SUITE_P(GuidedFlight, Stalls,
                         testing::Values(Stall{10.0, 1.5}, Stall{10.0, 3.0}, Stall{10.0, 6.0},
                                         Stall{11.5, 6.0}, Stall{20.0, 6.0}, Stall{24.0, 20.0}),
                         [](const auto& test) {
                           return "after" + std::to_string(static_cast<int>(test.param.begin)) +
                                  "for" + std::to_string(static_cast<int>(test.param.duration));
                         });

// The next setpoints start at the position of the vehicle, not at the last setpoint.
TEST_P(Stalls, EndAtVehiclePosition) {
  Flight flight({.jerk = default_jerk});
  StallingPort port(flight.autopilot, GetParam().begin, GetParam().duration);
  const MaybeFailure failure = flight.fly(port, {});
  ASSERT_TRUE(port.woken_at());
  if (!failure) GTEST_SKIP() << "it fell between two legs";
  EXPECT_EQ(failure->kind, FailureKind::stalled);
  EXPECT_THAT(failure->what,
              HasSubstr("this program was suspended; stopping at the current position"));
  EXPECT_LT(flight.cross_track_error(flight.autopilot.position()), 0.35);
  // From its maximum speed, the vehicle stops within 4 m.
  EXPECT_LT((flight.autopilot.position() - *port.woken_at()).norm(), 4.0);
  const MaybeFailure returned = flight.return_to_home();
  EXPECT_FALSE(returned) << returned->what;
  EXPECT_FALSE(flight.autopilot.is_armed());
}

// The vehicle flies through shorter stalls and never flies backwards.
TEST(GuidedFlight, FliesForwardAfterShortStall) {
  for (const double duration : {0.3, 0.6, 0.9}) {
    Flight flight({.jerk = default_jerk});
    StallingPort port(flight.autopilot, 9.0, duration);
    const MaybeFailure failure = flight.fly(port, {});
    ASSERT_FALSE(failure) << failure->what;
    const std::vector<Vector3d>& track = flight.autopilot.track();
    double farthest = -75.0;
    for (const Vector3d& position : testing_support::not_empty(track)) {
      if (position.y() > 0.5) break;  // the first leg leads to the east
      EXPECT_GT(position.x(), farthest - 0.3) << duration;
      farthest = std::max(farthest, position.x());
    }
  }
}

// ---- gimbals ---------------------------------------------------------------------------------

geometry::View view_at_the_end(double pitch) {
  return {path()[1], {std::cos(pitch), 0.0, std::sin(pitch)}};
}

MaybeFailure aimed(Flight& flight, SteppedPort& port, double pitch) {
  const flight::GeodeticPoint origin = options().site.origin;
  flight.link = std::make_unique<flight::mavlink::AutopilotLink>(port);
  if (MaybeFailure failure =
          prepare(*flight.link, {origin, pad}, pad, flight.motion.vehicle(), flight.limits, {})) {
    return failure;
  }
  flight.vehicle = std::make_unique<GuidedFlight>(*flight.link, FlightFrame(origin, pad),
                                                  flight.motion, flight.limits, std::stop_token());
  if (MaybeFailure failure = flight.vehicle->take_off(path()[0])) return failure;
  if (MaybeFailure failure = flight.vehicle->aim(view_at_the_end(pitch))) return failure;
  if (MaybeFailure failure = flight.vehicle->fly({path()[0], path()[1]})) return failure;
  return flight.vehicle->settle(view_at_the_end(pitch));
}

constexpr double degree = M_PI / 180.0;

double compute_view_pitch(const Flight& flight) {
  return std::asin(flight.vehicle->view().direction.z());
}

TEST(Gimbals, CompensateVehicleRelativeReports) {
  for (const double wind_pitch : {0.0, 1.0, 3.8, -6.0, 12.0}) {
    Flight flight({.wind_pitch = wind_pitch * degree, .gimbal_against_vehicle = true});
    SteppedPort port(flight.autopilot);
    const MaybeFailure failure = aimed(flight, port, -6.2 * degree);
    ASSERT_FALSE(failure) << failure->what;
    EXPECT_TRUE(flight.vehicle->reports_against_vehicle()) << wind_pitch;
    EXPECT_NEAR(compute_view_pitch(flight), -6.2 * degree, 0.2 * degree) << wind_pitch;
  }
}

TEST(Gimbals, UseHorizonRelativeReportsDirectly) {
  for (const double wind_pitch : {0.0, 3.8, -6.0}) {
    Flight flight({.wind_pitch = wind_pitch * degree});
    SteppedPort port(flight.autopilot);
    const MaybeFailure failure = aimed(flight, port, -6.2 * degree);
    ASSERT_FALSE(failure) << failure->what;
    EXPECT_FALSE(flight.vehicle->reports_against_vehicle());
    EXPECT_NEAR(compute_view_pitch(flight), -6.2 * degree, 0.2 * degree);
  }
}

// With a constant tilt, only the gimbal angle at the view reveals the frame of the report.
TEST(Gimbals, DetectReportFrameDuringSteadyTilt) {
  GimbalReport report;
  report.begin_aim(0.0, -0.1);
  for (double time = 0.0; time < 5.0; time += 0.1) report.hear(time, -0.1 - 0.06, 0.06);
  EXPECT_TRUE(report.is_against_vehicle());
  EXPECT_NEAR(report.camera_pitch(-0.16, 0.06), -0.1, 1e-12);
  GimbalReport horizon;
  horizon.begin_aim(0.0, -0.1);
  for (double time = 0.0; time < 5.0; time += 0.1) horizon.hear(time, -0.1, 0.06);
  EXPECT_FALSE(horizon.is_against_vehicle());
}

TEST(Gimbals, ReportStuckGimbal) {
  Flight flight({.gimbal_stuck = true});
  SteppedPort port(flight.autopilot);
  const MaybeFailure failure = aimed(flight, port, -20.0 * degree);
  ASSERT_TRUE(failure);
  EXPECT_THAT(
      failure->what,
      HasSubstr(
          "in the requested direction: gimbal pitch 0.0 degrees instead of -20.0 (tolerance 2)"));
  EXPECT_THAT(failure->what, testing::Not(HasSubstr("position")));
}

TEST(AimErrors, DescribeExceededTolerances) {
  EXPECT_EQ(describe_failures({}, 0.3), "");
  EXPECT_EQ(describe_failures({.position = 0.5}, 0.3), "position error 0.50 m (at most 0.30)");
  EXPECT_EQ(describe_failures({.speed = 0.4, .turn = 5.0 * degree}, 0.3),
            "speed 0.40 m/s (at most 0.2); heading error 5.0 degrees (at most 2)");
}

}  // namespace
}  // namespace skycap::missions::online
