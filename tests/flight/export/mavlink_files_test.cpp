// Validation rules of .plan and .waypoints files. Each case breaks one rule.
#include "flight/export/mavlink_files.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "tests/flight/export/sample_plan.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string& good_plan() {
  static const std::string text = write_plan(sample_plan(vehicle_profile("generic")));
  return text;
}

Problems after(const std::function<void(json&)>& change) {
  json plan = json::parse(good_plan());
  change(plan);
  return validate_plan(plan.dump());
}

json& item(json& plan, std::size_t i) { return plan["mission"]["items"][i]; }

// Rally points are at the home altitude independent of the terrain, because PX4 adds the return
// altitude to the altitude of the rally point.
TEST(PlanFile, ContainsVerifiedRallyPointsAtHomeHeight) {
  FlightPlan plan = sample_plan(vehicle_profile("generic"));
  plan.returns->rtl_profile.landings.emplace_back(35.0, 20.0, -1.0);
  const MavlinkMission file = read_plan(write_plan(plan));
  ASSERT_EQ(file.rally.size(), 1U);
  const Eigen::Vector3d position = LocalFrame(plan.site.origin).to_local(file.rally.front());
  EXPECT_LT((position.head<2>() - Eigen::Vector2d(35, 20)).norm(), 0.02);
  EXPECT_EQ(file.rally.front().height, 0.0);
}

TEST(PlanFile, ReportsInvalidTopLevelKeys) {
  EXPECT_THAT(validate_plan(good_plan()), IsEmpty());
  EXPECT_THAT(validate_plan("{"), Contains(HasSubstr("not a JSON object")));
  EXPECT_THAT(validate_plan("[]"), Contains(HasSubstr("not a JSON object")));
  EXPECT_THAT(after([](json& p) { p["fileType"] = "Mission"; }), Contains(HasSubstr("fileType")));
  EXPECT_THAT(after([](json& p) { p["version"] = 2; }), Contains("version must be 1"));
  EXPECT_THAT(after([](json& p) { p["version"] = "1"; }), Contains("version must be 1"));
  EXPECT_THAT(after([](json& p) { p.erase("groundStation"); }),
              Contains(HasSubstr("groundStation")));
  EXPECT_THAT(after([](json& p) { p.erase("mission"); }), Contains("mission is missing"));
  EXPECT_THAT(after([](json& p) { p["mission"]["version"] = 1; }),
              Contains("mission.version must be 2"));
  EXPECT_THAT(after([](json& p) { p.erase("geoFence"); }), Contains("geoFence is missing"));
  EXPECT_THAT(after([](json& p) { p["rallyPoints"]["version"] = 1; }),
              Contains("rallyPoints.version must be 2"));
  EXPECT_THAT(after([](json& p) {
                p["rallyPoints"]["points"] = {{1, 2}};
              }),
              Contains(HasSubstr("rallyPoints.points[0]")));
  EXPECT_THAT(after([](json& p) {
                p["mission"]["plannedHomePosition"] = {1, 2};
              }),
              Contains(HasSubstr("plannedHomePosition")));
  EXPECT_THAT(after([](json& p) { p["mission"]["firmwareType"] = "PX4"; }),
              Contains(HasSubstr("firmwareType")));
  EXPECT_THAT(after([](json& p) { p["mission"]["items"] = json::array(); }),
              Contains(HasSubstr("at least one item")));
}

TEST(PlanFile, ReportsInvalidItems) {
  const auto bad = [](const char* key, const json& value) {
    return after([&](json& p) { item(p, 2)[key] = value; });
  };
  EXPECT_THAT(bad("type", "ComplexItem"), Contains(HasSubstr("items[2].type")));
  EXPECT_THAT(bad("command", "16"), Contains(HasSubstr("items[2].command")));
  EXPECT_THAT(bad("frame", 3.5), Contains(HasSubstr("items[2].frame")));
  EXPECT_THAT(bad("autoContinue", 1), Contains(HasSubstr("items[2].autoContinue")));
  EXPECT_THAT(bad("doJumpId", 7), Contains(HasSubstr("doJumpId must be 3")));
  EXPECT_THAT(bad("params", {1, 2, 3}), Contains(HasSubstr("7 numbers")));
  EXPECT_THAT(bad("params", {"1", 2, 3, 4, 5, 6, 7}), Contains(HasSubstr("7 numbers")));
  EXPECT_THAT(bad("frame", 7), Contains(HasSubstr("has frame 7")));
  EXPECT_THAT(after([](json& p) { item(p, 0).erase("Altitude"); }), Contains(HasSubstr("or none")));
  EXPECT_THAT(after([](json& p) { item(p, 0)["AltitudeMode"] = 2; }),
              Contains(HasSubstr("conflicts with its frame")));
  EXPECT_THAT(after([](json& p) { item(p, 0)["Altitude"] = 99; }),
              Contains(HasSubstr("must equal the height in its params")));
}

TEST(PlanFile, ReportsInvalidItemContent) {
  EXPECT_THAT(after([](json& p) { item(p, 0)["params"][4] = 91; }),
              Contains(HasSubstr("latitude")));
  EXPECT_THAT(after([](json& p) { item(p, 0)["params"][5] = -181; }),
              Contains(HasSubstr("longitude")));
  EXPECT_THAT(after([](json& p) {
                item(p, 0)["params"][6] = 20000;
                item(p, 0)["Altitude"] = 20000;
              }),
              Contains(HasSubstr("height outside")));
  EXPECT_THAT(after([](json& p) { item(p, 0)["params"][4] = nullptr; }),
              Contains(HasSubstr("latitude")));
  EXPECT_THAT(after([](json& p) { item(p, 0)["command"] = 16; }),
              Contains(HasSubstr("must begin with a take-off")));
  EXPECT_THAT(after([](json& p) { p["mission"]["items"].erase(p["mission"]["items"].size() - 1); }),
              Contains(HasSubstr("must end with a landing")));
  EXPECT_THAT(after([](json& p) {
                for (json& i : p["mission"]["items"]) {
                  if (i["command"] == 205) i["command"] = 530;
                }
              }),
              Contains(HasSubstr("captures an image without a gimbal command")));
  EXPECT_THAT(after([](json& p) {
                item(p, 1)["command"] = 177;
                item(p, 1)["params"][0] = 500;
              }),
              Contains(HasSubstr("jumps to item 500")));
  EXPECT_THAT(after([](json& p) { item(p, 1)["command"] = 115; }),
              Contains(HasSubstr("PX4 rejects missions with this command")));
}

TEST(PlanFile, ReportsInvalidFencePolygons) {
  const auto polygon = [](json& p, std::size_t i) -> json& { return p["geoFence"]["polygons"][i]; };
  EXPECT_THAT(after([&](json& p) { polygon(p, 0).erase("inclusion"); }),
              Contains(HasSubstr("inclusion")));
  EXPECT_THAT(after([&](json& p) { polygon(p, 0)["version"] = 2; }),
              Contains(HasSubstr("version must be 1")));
  EXPECT_THAT(after([&](json& p) {
                polygon(p, 0)["polygon"] = {{1, 2}, {3, 4}};
              }),
              Contains(HasSubstr("at least 3 corners")));
  EXPECT_THAT(after([&](json& p) {
                json& corners = polygon(p, 0)["polygon"];
                corners.push_back(corners[0]);
              }),
              Contains(HasSubstr("must not repeat")));
}

TEST(PlanFile, ReportsInvalidFenceCircles) {
  const auto with_circle = [](double radius, bool is_inclusion) {
    return after([&](json& p) {
      const json home = p["mission"]["plannedHomePosition"];
      p["geoFence"]["circles"] = {
          {{"version", 1},
           {"inclusion", is_inclusion},
           {"circle", {{"center", {home[0], home[1]}}, {"radius", radius}}}}};
    });
  };
  EXPECT_THAT(with_circle(200, true), IsEmpty());
  EXPECT_THAT(with_circle(-5, false), Contains(HasSubstr("positive radius")));
}

TEST(PlanFile, ContainsAnglesCapturesAndHoldsOfPlan) {
  const FlightPlan plan = sample_plan(vehicle_profile("generic"));
  const RouteFile route = make_route(read_plan(good_plan()).items);
  const std::vector<StopTime> times = stop_times(plan);
  ASSERT_EQ(route.points.size(), plan.waypoints.size());
  for (std::size_t i = 0; i < route.points.size(); ++i) {
    const Waypoint& waypoint = plan.waypoints[i];
    EXPECT_EQ(route.points[i].datum, HeightDatum::takeoff);
    if (!waypoint.is_capture_point) continue;
    EXPECT_NEAR(route.points[i].yaw_deg, waypoint.yaw * 180 / M_PI, 1e-4);
    EXPECT_NEAR(route.points[i].pitch_deg, waypoint.pitch * 180 / M_PI, 1e-4);
    EXPECT_EQ(route.points[i].captures, 2);
    EXPECT_NEAR(route.points[i].hold, times[i].departure - times[i].arrival, 1e-3);
  }
}

// ---- autopilot dialects ----------------------------------------------------------------------

TEST(MissionItems, SetYawInPx4WaypointsAndInArduPilotConditionYaw) {
  const auto count = [](const std::vector<MissionItem>& items, int command) {
    return std::count_if(items.begin(), items.end(),
                         [&](const MissionItem& i) { return i.command == command; });
  };
  const auto px4 = mission_items(sample_plan(vehicle_profile("generic")));
  const auto ardupilot = mission_items(sample_plan(vehicle_profile("generic_ardupilot")));
  EXPECT_EQ(count(px4, command::condition_yaw), 0);
  EXPECT_EQ(count(ardupilot, command::condition_yaw), 4);
  EXPECT_THAT(check_items(px4, AutopilotType::px4), IsEmpty());
  EXPECT_THAT(check_items(ardupilot, AutopilotType::ardupilot), IsEmpty());
  EXPECT_THAT(check_items(ardupilot, AutopilotType::px4), testing::Not(IsEmpty()));
}

std::vector<int> commands(const std::vector<MissionItem>& items, std::size_t first,
                          std::size_t count) {
  std::vector<int> result;
  for (std::size_t i = first; i < first + count; ++i) result.push_back(items.at(i).command);
  return result;
}

// ArduPilot starts the gimbal and then the yaw on the leg to the waypoint. In the reverse order the
// gimbal would wait for the yaw. The capture is between two delays, because otherwise the vehicle
// would leave while the shutter is open.
TEST(MissionItems, AimEnRouteAndHoldAfterCaptureForArduPilot) {
  const FlightPlan plan = sample_plan(vehicle_profile("generic_ardupilot"));
  const std::vector<StopTime> times = stop_times(plan);
  const auto items = mission_items(plan);
  using namespace command;
  EXPECT_EQ(commands(items, 0, 4),
            (std::vector{takeoff, change_speed, change_speed, change_speed}));
  std::size_t next = 4, stop = 1, capture_points = 0;
  for (; items[next].command != land; ++stop) {
    const Waypoint& waypoint = plan.waypoints[stop];
    if (!waypoint.is_capture_point) {
      EXPECT_EQ(commands(items, next, 2), (std::vector{command::waypoint, delay}));
      EXPECT_EQ(items[next].params[0], 0.0);
      EXPECT_DOUBLE_EQ(items[next + 1].params[0], corner_hold);
      next += 2;
      continue;
    }
    EXPECT_EQ(commands(items, next, 7),
              (std::vector{mount_control, condition_yaw, command::waypoint, delay, start_capture,
                           start_capture, delay}));
    EXPECT_EQ(items[next + 2].params[0], 0.0);
    EXPECT_NEAR(items[next + 3].params[0], times[stop].capture - times[stop].arrival, 1e-3);
    EXPECT_GE(items[next + 3].params[0], waypoint.hold - 1e-3);
    EXPECT_DOUBLE_EQ(items[next + 6].params[0], waypoint.hold_after);
    ++capture_points, next += 7;
  }
  EXPECT_EQ(capture_points, 4U);
  EXPECT_EQ(stop, plan.waypoints.size());
}

// The file sets the speeds of the plan, independent of the vehicle's parameters.
TEST(MissionItems, SetTheSpeedsOfThePlan) {
  const FlightPlan plan = sample_plan(vehicle_profile("generic_ardupilot"));
  const auto items = mission_items(plan);
  const double speeds[] = {plan.conditions.cruise_speed, plan.vehicle.mode.max_ascent,
                           plan.vehicle.mode.max_descent};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(items[1 + i].params[0], static_cast<double>(i + 1));
    EXPECT_EQ(items[1 + i].params[1], speeds[i]);
  }
}

TEST(MissionItems, HoldInWaypointAndDelayAfterCaptureForPx4) {
  const auto items = mission_items(sample_plan(vehicle_profile("generic")));
  using namespace command;
  ASSERT_FALSE(items.empty());
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].command != mount_control) continue;
    EXPECT_EQ(commands(items, i, 5),
              (std::vector{mount_control, waypoint, start_capture, start_capture, delay}));
    EXPECT_GE(items[i + 1].params[0], 2.0);
  }
}

TEST(MissionItems, MatchArduPilotStorageRounding) {
  auto items = mission_items(sample_plan(vehicle_profile("generic_ardupilot")));
  EXPECT_THAT(check_items(as_stored(items, AutopilotType::ardupilot), AutopilotType::ardupilot),
              IsEmpty());
  for (MissionItem& item : items) {
    if (item.command == command::waypoint) item.params[0] = 1.5;
  }
  EXPECT_THAT(check_items(items, AutopilotType::ardupilot), Contains(HasSubstr("whole seconds")));
  MissionItem stored{
      command::waypoint, frame::relative, {1.9, 0, 0, 0, 51.12345678, -1.23456789, 7.257}};
  stored = as_stored({stored}, AutopilotType::ardupilot)[0];
  EXPECT_EQ(stored.params[0], 1.0);
  EXPECT_DOUBLE_EQ(stored.params[4], 51.1234568);
  EXPECT_DOUBLE_EQ(stored.params[6], 7.25);
}

TEST(MissionItems, ReportGimbalCommandsThatArduPilotWouldAlter) {
  auto items = mission_items(sample_plan(vehicle_profile("generic_ardupilot")));
  const auto with = [&](std::array<double, 7> params) {
    items[1] = {command::gimbal_pitch_yaw, frame::mission, params};
    return check_items(items, AutopilotType::ardupilot);
  };
  EXPECT_THAT(with({-7, 0, 0, 0, 0, 0, 0}), IsEmpty());
  EXPECT_THAT(with({-7.5, 0, 0, 0, 0, 0, 0}), Contains(HasSubstr("fraction of a degree")));
  EXPECT_THAT(with({-7, 0, unspecified, 0, 0, 0, 0}), Contains(HasSubstr("no parameter 3")));
}

TEST(MissionItems, RejectMoreItemsThanVehicleAccepts) {
  FlightPlan plan = sample_plan(vehicle_profile("generic"));
  plan.vehicle.max_waypoints = 10;
  EXPECT_THAT(testing_support::thrown_message([&] { mission_items(plan); }),
              testing::HasSubstr("mission items; vehicle \"generic\" accepts 10"));
  EXPECT_THAT(
      testing_support::thrown_message([&] { write_plan(sample_plan(vehicle_profile("m30t"))); }),
      testing::HasSubstr("does not support MAVLink missions"));
}

// ---- .waypoints ------------------------------------------------------------------------------

TEST(WaypointsFile, HasTabsAndHomeForArduPilotAndNoNan) {
  const std::string px4 = write_waypoints(sample_plan(vehicle_profile("generic")));
  const std::string ardupilot = write_waypoints(sample_plan(vehicle_profile("generic_ardupilot")));
  EXPECT_TRUE(px4.starts_with("QGC WPL 110\n0\t1\t3\t22\t"));
  EXPECT_TRUE(
      ardupilot.starts_with("QGC WPL 110\n0\t1\t0\t16\t0.0000\t0.0000\t0.0000\t0.0000\t51.75"));
  EXPECT_THAT(px4 + ardupilot, testing::Not(HasSubstr("nan")));
  EXPECT_THAT(validate_waypoints(px4, AutopilotType::px4), IsEmpty());
  EXPECT_THAT(validate_waypoints(ardupilot, AutopilotType::ardupilot), IsEmpty());
  EXPECT_THAT(validate_waypoints(px4, AutopilotType::ardupilot),
              Contains(HasSubstr("must be home")));
  EXPECT_THAT(validate_waypoints(ardupilot, AutopilotType::px4), Contains(HasSubstr("is a home")));
  EXPECT_EQ(make_route(read_waypoints(px4).items).points.size(),
            make_route(read_waypoints(ardupilot).items).points.size());
  EXPECT_EQ(read_waypoints(px4).items.front().number, 0U);
  EXPECT_EQ(read_waypoints(ardupilot).items.front().number, 1U);
}

TEST(WaypointsFile, ReportsInvalidText) {
  const std::string good = write_waypoints(sample_plan(vehicle_profile("generic")));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return validate_waypoints(text, AutopilotType::px4);
  };
  std::string windows = good;
  for (std::size_t i = 0; (i = windows.find('\n', i)) != std::string::npos; i += 2) {
    windows.replace(i, 1, "\r\n");
  }
  EXPECT_THAT(validate_waypoints(windows, AutopilotType::px4), IsEmpty());
  EXPECT_THAT(with("WPL 110", "WPL 120"), Contains(HasSubstr("line 1")));
  EXPECT_THAT(with("\n0\t1\t3\t22", "\n0 1 3 22"), Contains(HasSubstr("separated by tabs")));
  EXPECT_THAT(with("\n0\t1\t3", "\n# a comment\n0\t1\t3"),
              Contains(HasSubstr("line 2 has 1 fields")));
  EXPECT_THAT(with("\n1\t0\t", "\n7\t0\t"), Contains(HasSubstr("index 7")));
  EXPECT_THAT(with("\n1\t0\t", "\n1\t1\t"), Contains(HasSubstr("current")));
  EXPECT_THAT(with("\t22\t0.0000", "\t22\tNaN"), Contains(HasSubstr("\"NaN\"")));
  EXPECT_THAT(with("\t22\t", "\t22.5\t"), Contains(HasSubstr("it must be an integer")));
  EXPECT_THAT(with("\t22\t", "\t16\t"), Contains(HasSubstr("take-off")));
}

}  // namespace
}  // namespace skycap::flight
