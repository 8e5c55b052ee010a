// Live surveys flown by the test autopilot, with the faults that each test selects.
#include "missions/online/guided/fly_survey.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/online/guided/simulated_autopilot.h"
#include "tests/missions/online/live/rehearsal.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/complaint.h"

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

std::string mission_text() {
  std::string text = online::short_mission(tests::flight_mission());
  const std::string vehicle = "vehicle: generic";
  return text.insert(text.find(vehicle) + vehicle.size(), "_ardupilot");
}

/// A survey, its autopilot, and the messages of the flight.
class FlySurvey : public testing::Test {
 protected:
  FlightEnd fly(const AutopilotFaults& faults = {}, FlightOptions options = {}) {
    survey_.reset();
    survey_.reset(new online::LiveSurvey(rehearsal_.open(folder_->path())));
    autopilot_ = std::make_unique<SimulatedAutopilot>(rehearsal_.setup().flight(),
                                                      survey_->flight()->pad(), faults);
    if (!launches_) options.launch = run_at_once;
    options.note = [this](const std::string& text) { notes_ += text + "\n"; };
    SteppedPort port(*autopilot_);
    return fly_survey(rehearsal_.setup().flight(), *survey_, port, sensor_, options,
                      stop_.get_token());
  }

  void restart() {
    survey_.reset();
    folder_ = std::make_unique<tests::TestFolder>();
  }

  const online::Rehearsal rehearsal_{mission_text()};
  std::unique_ptr<tests::TestFolder> folder_ = std::make_unique<tests::TestFolder>();
  /// Poses are exact, so scans equal those of `plan`.
  Sensor sensor_ = [this](const geometry::View&, const geometry::View&, std::size_t) {
    return rehearsal_.scan(*survey_);
  };
  bool launches_ = false;
  std::stop_source stop_;
  std::unique_ptr<online::LiveSurvey> survey_;
  std::unique_ptr<SimulatedAutopilot> autopilot_;
  std::string notes_;
};

double find_nearest(const std::vector<Vector3d>& positions, const scene::SceneOptions& scene) {
  const geometry::MeshDistance truth(evaluation::placed_model(scene, ""));
  double nearest = 1e9;
  for (const Vector3d& position : positions) nearest = std::min(nearest, truth.distance(position));
  return nearest;
}

TEST_F(FlySurvey, MatchesPlanAndKeepsClearance) {
  const FlightEnd end = fly();
  ASSERT_FALSE(end.failure) << end.failure->what << "\n" << notes_;
  EXPECT_TRUE(end.has_landed);
  EXPECT_FALSE(autopilot_->is_armed());
  const config::MissionSetup& setup = rehearsal_.setup();
  const Vector3d off = autopilot_->position() - survey_->flight()->pad();
  EXPECT_LT(off.norm(), setup.flight().tracking_error);
  const flight::ClearanceBudget clearance = setup.flight().budget();
  // Setpoints are rounded to 1e-7 degrees, 1.1 cm.
  EXPECT_GT(find_nearest(autopilot_->set_points(), setup.scene()),
            clearance.total() - clearance.map_error - 0.02);
  EXPECT_GT(find_nearest(autopilot_->track(), setup.scene()),
            clearance.total() - clearance.map_error - clearance.tracking_error);
  online::expect_same(survey_->finish(), rehearsal_.planned());
}

/// A tenth of the frames is lost and a twentieth is damaged. Others arrive twice or late.
TEST_F(FlySurvey, MatchesPlanOverLossyLink) {
  const FlightEnd end = fly({.lost = 0.1, .doubled = 0.1, .damaged = 0.05, .late = 0.1});
  ASSERT_FALSE(end.failure) << end.failure->what << "\n" << notes_;
  EXPECT_TRUE(end.has_landed);
  online::expect_same(survey_->finish(), rehearsal_.planned());
}

TEST_F(FlySurvey, ReturnsWhenInterruptedAndResumesLater) {
  const Sensor exact = sensor_;
  sensor_ = [&](const geometry::View& requested, const geometry::View& actual_view,
                std::size_t number) {
    if (number == 2) stop_.request_stop();
    return exact(requested, actual_view, number);
  };
  const FlightEnd end = fly({}, {.returns_on_failure = true});
  ASSERT_TRUE(end.failure);
  EXPECT_EQ(end.failure->kind, FailureKind::interrupted);
  EXPECT_TRUE(end.has_landed);
  EXPECT_FALSE(autopilot_->is_armed());

  stop_ = {};
  sensor_ = exact;
  const FlightEnd second = fly();
  ASSERT_FALSE(second.failure) << second.failure->what;
  EXPECT_TRUE(second.has_landed);
  const session::SurveyRecord record = survey_->finish();
  EXPECT_EQ(online::positions(record.views), online::positions(rehearsal_.planned().views));
}

TEST_F(FlySurvey, YieldsControlToPilotImmediately) {
  const FlightEnd end = fly({.pilot_takes_over = 30.0}, {.returns_on_failure = true});
  ASSERT_TRUE(end.failure);
  EXPECT_EQ(end.failure->kind, FailureKind::pilot);
  EXPECT_THAT(end.failure->what, HasSubstr("mode 5"));
  EXPECT_FALSE(end.has_landed);
  EXPECT_EQ(autopilot_->mode(), 5U);
  // The mode is reported once a second.
  EXPECT_LT(autopilot_->time() - autopilot_->taken_off() - 30.0, 1.3);
}

/// Returns true if each position is within `distance` of one of the others.
bool are_near(const std::vector<Vector3d>& positions, const std::vector<Vector3d>& others,
              double distance) {
  return std::ranges::all_of(positions, [&](const Vector3d& position) {
    return std::ranges::any_of(
        others, [&](const Vector3d& other) { return (position - other).norm() < distance; });
  });
}

/// Setpoints are at most 0.5 m apart. The path from the pad begins without setpoints.
TEST_F(FlySurvey, StaysOnLegsWhenLinkIsLost) {
  fly();
  const std::vector<Vector3d> legs = autopilot_->set_points();
  const Vector3d above_pad = survey_->flight()->above_pad();
  const double near = rehearsal_.setup().flight().tracking_error + 0.25;
  for (int i = 0; i < 12; ++i) {
    restart();
    const double silent = 8.0 + 3.7 * i;
    const FlightEnd end = fly({.silent = silent}, {.returns_on_failure = true});
    ASSERT_TRUE(end.failure);
    EXPECT_EQ(end.failure->kind, FailureKind::link) << end.failure->what;
    std::vector<Vector3d> track;
    for (const Vector3d& position : autopilot_->track()) {
      if ((position - above_pad).head<2>().norm() > near) track.push_back(position);
    }
    EXPECT_TRUE(are_near(track, legs, near)) << "silent after " << silent << " s";
    const std::vector<Vector3d>& whole = autopilot_->track();
    EXPECT_LT((whole.back() - whole[whole.size() - 25]).norm(), 0.01);  // at rest
  }
}

/// Requests a hold for 20 s at different times of the flight.
TEST_F(FlySurvey, HoldsOnRequestAndContinuesOnTheSameLegs) {
  constexpr double held = 20.0;
  fly();
  const double duration = autopilot_->time() - autopilot_->taken_off();
  const std::vector<Vector3d> legs = autopilot_->set_points();
  const Vector3d above_pad = survey_->flight()->above_pad();
  const double near = rehearsal_.setup().flight().tracking_error + 0.25;
  const session::SurveyRecord planned = rehearsal_.planned();
  for (int i = 0; i < 5; ++i) {
    restart();
    const double begin = 12.0 + 8.3 * i;
    FlightOptions options;
    options.observer.is_held = [&] {
      if (!autopilot_->has_taken_off()) return false;
      const double time = autopilot_->time() - autopilot_->taken_off() - begin;
      return time > 0.0 && time < held;
    };
    std::size_t tracked = 0;
    options.observer.track = [&](const geometry::View& view, std::optional<double> battery) {
      EXPECT_LT((view.position - autopilot_->position()).norm(), 1.0);  // of 0.1 s earlier
      EXPECT_TRUE(battery);
      ++tracked;
    };
    const FlightEnd end = fly({}, options);
    ASSERT_FALSE(end.failure) << end.failure->what << "\n" << notes_;
    EXPECT_TRUE(end.has_landed);
    EXPECT_THAT(notes_, HasSubstr("holding position on request\nhold released"));
    EXPECT_GT(tracked, 100U);
    const double longer = autopilot_->time() - autopilot_->taken_off() - duration;
    EXPECT_GT(longer, 0.3 * held) << begin;  // scanning and settling continue during a hold
    EXPECT_LT(longer, held + 10.0) << begin;
    std::vector<Vector3d> track;
    for (const Vector3d& position : autopilot_->track()) {
      if ((position - above_pad).head<2>().norm() > near) track.push_back(position);
    }
    EXPECT_TRUE(are_near(track, legs, near)) << begin;
    // Ten setpoints per second of the hold are equal.
    const std::vector<Vector3d>& sent = autopilot_->set_points();
    std::size_t longest = 0, run = 0;
    for (std::size_t k = 1; k < sent.size(); ++k) {
      run = sent[k] == sent[k - 1] ? run + 1 : 0;
      longest = std::max(longest, run);
    }
    EXPECT_GT(longest, 100U) << begin;
    EXPECT_EQ(online::positions(survey_->finish().views), online::positions(planned.views));
    notes_.clear();
  }
}

TEST_F(FlySurvey, ReturnsOnBatteryFailsafeWhileHeld) {
  FlightOptions options;
  options.observer.is_held = [&] {
    return autopilot_->has_taken_off() && autopilot_->time() - autopilot_->taken_off() > 20.0;
  };
  const FlightEnd end = fly({.battery_fails = 60.0}, options);
  ASSERT_TRUE(end.failure);
  EXPECT_EQ(end.failure->kind, FailureKind::battery);
  EXPECT_TRUE(end.has_landed);
}

TEST_F(FlySurvey, DoesNotTakeOffWhileHeld) {
  FlightOptions options;
  options.observer.is_held = [] { return true; };
  const FlightEnd end = fly({}, options);
  ASSERT_TRUE(end.failure);
  EXPECT_THAT(end.failure->what, HasSubstr("resume it before the take-off"));
  EXPECT_TRUE(autopilot_->track().empty());
}

struct HeldFlight {
  const char* name;
  AutopilotFaults faults;
  FailureKind kind;
};

class HeldFlights : public FlySurvey, public testing::WithParamInterface<HeldFlight> {};

/// Even if a return is requested, because the vehicle's position is unknown.
TEST_P(HeldFlights, HoldPositionUntilPilotTakesOver) {
  const FlightEnd end = fly(GetParam().faults, {.returns_on_failure = true});
  ASSERT_TRUE(end.failure);
  EXPECT_EQ(end.failure->kind, GetParam().kind) << end.failure->what;
  EXPECT_FALSE(end.has_landed);
  EXPECT_THAT(notes_, HasSubstr("holding position"));
  EXPECT_THAT(notes_, HasSubstr("another station or the pilot has control"));
  const std::vector<Vector3d>& sent = autopilot_->set_points();
  EXPECT_EQ(sent.back(), sent[sent.size() - 50]);
}

INSTANTIATE_TEST_SUITE_P(
    All, HeldFlights,
    testing::Values(HeldFlight{"position_stops",
                               {.position_stops = 30.0, .pilot_takes_over = 60.0},
                               FailureKind::position},
                    HeldFlight{"estimate_lost",
                               {.estimate_lost = 30.0, .pilot_takes_over = 60.0},
                               FailureKind::position},
                    HeldFlight{"blown_away",
                               {.pilot_takes_over = 60.0, .blown_away = 30.0},
                               FailureKind::off_leg}),
    [](const auto& test) { return test.param.name; });

TEST_F(FlySurvey, HoldsPositionUnlessReturnIsEnabled) {
  sensor_ = [](const geometry::View&, const geometry::View&, std::size_t) -> geometry::Scan {
    throw Error(ErrorKind::bad_file, "the camera does not answer");
  };
  const FlightEnd end = fly({.pilot_takes_over = 90.0});
  EXPECT_EQ(end.failure->kind, FailureKind::sensor);
  EXPECT_THAT(end.failure->what, HasSubstr("the camera does not answer"));
  EXPECT_FALSE(end.has_landed);
}

TEST_F(FlySurvey, ReturnsWhenPlannerTimesOut) {
  std::vector<std::promise<void>> never;
  FlightOptions options{.returns_on_failure = true};
  int works = 0;
  launches_ = true;
  options.launch = [&](const std::function<void()>& work) {
    constexpr int second_plan_work = 6;
    return ++works < second_plan_work ? run_at_once(work) : never.emplace_back().get_future();
  };
  const FlightEnd end = fly({}, options);
  ASSERT_TRUE(end.failure);
  EXPECT_EQ(end.failure->kind, FailureKind::planner);
  EXPECT_THAT(end.failure->what, HasSubstr("planning the next view took more than 60 s"));
  EXPECT_TRUE(end.has_landed);
  EXPECT_GT(find_nearest(autopilot_->set_points(), rehearsal_.setup().scene()), 1.88);
}

TEST_F(FlySurvey, ReturnsOnBatteryFailsafe) {
  const FlightEnd end = fly({.battery_fails = 30.0});
  ASSERT_TRUE(end.failure);
  EXPECT_EQ(end.failure->kind, FailureKind::battery);
  EXPECT_TRUE(end.has_landed);
}

struct GroundedFlight {
  const char* name;
  AutopilotFaults faults;
  const char* message;
};

class GroundedFlights : public FlySurvey, public testing::WithParamInterface<GroundedFlight> {};

TEST_P(GroundedFlights, DoNotTakeOff) {
  const FlightEnd end = fly(GetParam().faults);
  ASSERT_TRUE(end.failure);
  EXPECT_THAT(end.failure->what, HasSubstr(GetParam().message));
  EXPECT_TRUE(autopilot_->track().empty());
  EXPECT_TRUE(autopilot_->set_points().empty());
}

INSTANTIATE_TEST_SUITE_P(
    All, GroundedFlights,
    testing::Values(
        GroundedFlight{"not_armed", {.rejects_arming = true}, "arm (result 4): PreArm: Compass"},
        GroundedFlight{"armed", {.is_armed = true}, "is armed"},
        GroundedFlight{"px4", {.autopilot = 12}, "only ArduCopter is"},
        GroundedFlight{"beside_the_pad", {.pad_offset = {3.0, 4.0, 0.0}}, "5.0 m horizontally"},
        GroundedFlight{"no_gimbal", {.has_no_gimbal = true}, "parameter MNT1_TYPE is 0; configure"},
        GroundedFlight{"no_gimbal_and_no_parameters",
                       {.has_no_gimbal = true, .answers_parameters = false},
                       "rejected the command (result 4) to turn the gimbal; configure"},
        GroundedFlight{"short_timeout",
                       {.guided_timeout = 0.2F},
                       "GUID_TIMEOUT must be from 0.5 to 5 s, but is 0.2 s"},
        GroundedFlight{"flat_battery", {.battery = 0.265}, "battery at 26%"}),
    [](const auto& test) { return test.param.name; });

/// The same vehicle with a fixed camera, 20 degrees down.
class FlySurveyWithFixedCamera : public testing::Test {
 protected:
  FlySurveyWithFixedCamera() {
    std::ofstream(folder_.path() / "bolted.yaml")
        << "name: bolted\nlike: generic_ardupilot\ngimbal_min_deg: -20\ngimbal_max_deg: -20\n";
    std::string text = online::short_mission(tests::flight_mission());
    const std::string vehicle = "vehicle: generic";
    text.replace(text.find(vehicle), vehicle.size(),
                 "vehicle: " + (folder_.path() / "bolted.yaml").string());
    text += "start: {position: [-30, 0, 10], direction: [0.9396926, 0, -0.3420201]}\n";
    rehearsal_ = std::make_unique<online::Rehearsal>(text);
  }

  const tests::TestFolder folder_;
  std::unique_ptr<online::Rehearsal> rehearsal_;
};

TEST_F(FlySurveyWithFixedCamera, TurnsTheVehicleAlone) {
  online::LiveSurvey survey = rehearsal_->open(folder_.path() / "survey");
  // The vehicle has no gimbal, and the wind tilts it.
  SimulatedAutopilot autopilot(rehearsal_->setup().flight(), survey.flight()->pad(),
                               {.wind_pitch = 0.05, .has_no_gimbal = true});
  SteppedPort port(autopilot);
  std::vector<double> asked, actual_view;
  const Sensor sensor = [&](const geometry::View& requested, const geometry::View& at,
                            std::size_t) {
    asked.push_back(std::asin(requested.direction.z()));
    actual_view.push_back(std::asin(at.direction.z()));
    return rehearsal_->scan(survey);
  };
  FlightOptions options;
  options.launch = run_at_once;
  const FlightEnd end = fly_survey(rehearsal_->setup().flight(), survey, port, sensor, options, {});
  ASSERT_FALSE(end.failure) << end.failure->what;
  EXPECT_TRUE(end.has_landed);
  ASSERT_GT(asked.size(), 3U);
  const double pitch = -20.0 * geometry::radians_per_degree;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    EXPECT_NEAR(asked[i], pitch, 1e-4) << i;
    // As the vehicle reports its own pitch. It still decelerates with up to 0.2 m/s^2.
    EXPECT_NEAR(actual_view[i], pitch + 0.05, 0.02) << i;
  }
}

TEST_F(FlySurvey, LandsOnPadAfterOffsetTakeOff) {
  const FlightEnd end = fly({.pad_offset = {1.0, -1.0, 0.0}});
  ASSERT_FALSE(end.failure) << end.failure->what;
  EXPECT_LT((autopilot_->position() - survey_->flight()->pad()).norm(), 0.3);
}

}  // namespace
}  // namespace skycap::missions::online
