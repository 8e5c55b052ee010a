// Interpretation of corrupted missions. Each kind of corruption that a review found undetected is
// now rejected with its item, or verified as it is flown.
#include "flight/interpreter/mission_interpreter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/interpreter/command_table.h"
#include "flight/interpreter/item_order.h"
#include "geometry/error.h"
#include "tests/flight/interpreter/spoiled.h"
#include "tests/support/complaint.h"
#include "tests/support/not_empty.h"

namespace skycap::flight {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class MissionInterpreter : public testing::TestWithParam<AutopilotType> {
 protected:
  MavlinkMission good() const { return sample_file(GetParam()); }  // namespace
  Problems after(const std::function<void(MavlinkMission&)>& change) const {
    MavlinkMission file = good();
    change(file);
    return find_problems(file, GetParam());
  }
  /// Matches a problem that names the item of this index by its number.
  static auto names(const MavlinkMission& file, std::size_t index, const std::string& what) {
    return Contains(
        AllOf(testing::StartsWith(item_label(file.items[index]) + " "), HasSubstr(what)));
  }
};

INSTANTIATE_TEST_SUITE_P(Interpreter, MissionInterpreter,
                         testing::Values(AutopilotType::px4, AutopilotType::ardupilot),
                         [](const auto& parameter) {
                           return parameter.param == AutopilotType::px4 ? "px4" : "ardupilot";
                         });

TEST_P(MissionInterpreter, AcceptsExportedFiles) {
  EXPECT_THAT(find_problems(good(), GetParam()), IsEmpty());
}

// Commands that are not in the table are rejected with their item.
TEST_P(MissionInterpreter, RejectsEveryUnknownCommand) {
  const MavlinkMission file = good();
  MavlinkMission corrupted = file;
  const std::size_t i = find_index(file, command::waypoint, 1);
  const FlightFacts facts = sample_facts(GetParam());
  for (int id = 0; id < 65536; ++id) {
    if (find_command(id) != nullptr) continue;
    corrupted.items[i].command = id;
    const Problems problems = interpret(corrupted, facts).problems;
    ASSERT_THAT(problems, Contains(item_label(file.items[i]) + " (command " + std::to_string(id) +
                                   ") is an unsupported command; remove it"));
  }
}

TEST_P(MissionInterpreter, RejectsUnsupportedCommands) {
  int rejected = 0;
  for (int id = 0; id < 65536; ++id) {
    const CommandRow* const row = find_command(id);
    if (row == nullptr || row->meaning != Meaning::rejected) continue;
    ++rejected;
    const std::size_t i = find_index(good(), command::waypoint, 1);
    EXPECT_THAT(after([&](MavlinkMission& f) { f.items[i].command = id; }),
                names(good(), i, row->name));
  }
  EXPECT_GT(rejected, 10);
}

TEST_P(MissionInterpreter, ReportsLoiterInsideWall) {
  const std::size_t i = find_index(good(), command::waypoint, 1);
  EXPECT_THAT(after([&](MavlinkMission& f) {
                f.items[i].command = command::loiter_time;
                move(f.items[i], {-9.5, 0, 8});
              }),
              Contains(AllOf(HasSubstr("leg from "), HasSubstr(item_label(good().items[i])),
                             HasSubstr("0.00 m from "))));
}

TEST_P(MissionInterpreter, RejectsLandingsOffTheTakeOffPoint) {
  const std::size_t i = find_index(good(), command::land);
  const auto landing_at = [&](const Eigen::Vector3d& position) {
    return after([&](MavlinkMission& f) { move(f.items[i], position); });
  };
  EXPECT_THAT(landing_at({0, 0, 0}), names(good(), i, "m from the take-off point"));
  EXPECT_THAT(landing_at({0, 0, 0}), Contains(HasSubstr("leg from item")));
  EXPECT_THAT(landing_at({-30, 25, 0}), names(good(), i, "lands 50.0 m from the take-off point"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[i].command = command::return_to_launch; }),
              names(good(), i, "RETURN_TO_LAUNCH"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[i - 1].command = command::return_to_launch; }),
              names(good(), i - 1, "RETURN_TO_LAUNCH"));
  // A landing in the middle of the route ends the flight there.
  const std::size_t middle = find_index(good(), command::waypoint, 2);
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[middle].command = command::land; }),
              AllOf(names(good(), middle, "m from the take-off point"),
                    names(good(), middle + 1, "after the landing")));
}

TEST_P(MissionInterpreter, RejectsChangedHoldsRadiiAndSpeeds) {
  const std::size_t waypoint_index = find_waypoint(good()), hold = find_hold(good());
  EXPECT_THAT(after([&](MavlinkMission& f) {
                f.items[waypoint_index].params[0] = 0.0;
                if (hold != waypoint_index) {
                  f.items.erase(f.items.begin() + static_cast<std::ptrdiff_t>(hold));
                }
              }),
              Not(IsEmpty()));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[hold].params[0] = 1.0; }),
              names(good(), waypoint_index, "holds 1.00 s before its image"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[waypoint_index].params[1] = 20.0; }),
              Contains(HasSubstr("captures an image where the vehicle does not stop")));
  const std::size_t speed = find_index(good(), command::change_speed);
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[speed].params[1] = 15.0; }),
              names(good(), speed, "sets 15.00 m/s"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[speed].params[1] = -1.0; }),
              names(good(), speed, "sets -1.00 m/s"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[speed].params[0] = 4.0; }),
              names(good(), speed, "speed type"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items.erase(f.items.begin() + speed); }),
              Contains(HasSubstr("no previous item sets the speed")));
}

TEST_P(MissionInterpreter, RejectsCapturesThatDifferFromViews) {
  const bool is_px4 = GetParam() == AutopilotType::px4;
  const std::size_t waypoint_index = find_waypoint(good());
  const std::size_t yaw = is_px4 ? waypoint_index : find_index(good(), command::condition_yaw);
  const std::size_t field = is_px4 ? 3 : 0;
  EXPECT_THAT(after([&](MavlinkMission& f) {
                double& heading = f.items[yaw].params[field];
                heading = std::fmod(heading + 90.0, 360.0);
              }),
              names(good(), waypoint_index, "degrees away from its view"));
  const std::size_t mount = find_index(good(), command::mount_control);
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[mount].params[0] -= 3.0; }),
              names(good(), waypoint_index, "degrees away from its view"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[mount].params[0] = -100.0; }),
              names(good(), waypoint_index, "cannot"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[mount].params[6] = 3.0; }),
              names(good(), mount, "must set the gimbal angles"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[waypoint_index].params[6] += 0.5; }),
              names(good(), waypoint_index,
                    "captures an image at a position that is not a view of the mission"));
}

TEST_P(MissionInterpreter, RejectsHomeAwayFromTakeOffPoint) {
  EXPECT_THAT(
      after([](MavlinkMission& f) { f.home->height += 30.0; }),
      Contains(AllOf(HasSubstr(sample_file(GetParam()).home_name), HasSubstr("30.0 m above"))));
  EXPECT_THAT(after([](MavlinkMission& f) { f.home->latitude_deg += 60.0 / 111250.0; }),
              Contains(HasSubstr("m from the take-off point")));
  const std::size_t i = find_index(good(), command::takeoff);
  EXPECT_THAT(after([&](MavlinkMission& f) {
                move(f.items[i], {-30, 0, 5});
              }),
              names(good(), i, "takes off 25.0 m from the mission's take-off point"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[i].params[6] = -1.0; }),
              names(good(), i, "not above the take-off point"));
}

// The altitude reference of one item does not affect the others.
TEST_P(MissionInterpreter, AppliesAltitudeReferencePerItem) {
  const std::size_t i = find_index(good(), command::waypoint, 1);
  const double pad_amsl = 111.5 - 46.7;
  EXPECT_THAT(after([&](MavlinkMission& f) {
                f.items[i].frame = frame::global;
                f.items[i].params[6] += pad_amsl;
              }),
              IsEmpty());
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[i].frame = frame::global; }),
              Contains(HasSubstr("leg from item")));
  EXPECT_THAT(after([&](MavlinkMission& f) {
                f.items[i].frame = frame::global;
                f.items[i].params[6] += pad_amsl;
                move(f.items[find_waypoint(f, 1)], {-9.5, 0, 8});
              }),
              Not(IsEmpty()));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[i].frame = frame::terrain; }),
              names(good(), i, "frame 10"));
  MavlinkMission file = good();
  file.items[i].frame = frame::global;
  FlightFacts facts = sample_facts(GetParam());
  facts.site.geoid_undulation.reset();
  EXPECT_THAT(testing_support::thrown_message([&] { interpret(file, facts); }),
              testing::HasSubstr(" (AMSL) requires"));
}

TEST_P(MissionInterpreter, RejectsZeroPositionsAndHeights) {
  const std::size_t i = find_index(good(), command::waypoint, 1);
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[i].params[4] = f.items[i].params[5] = 0.0; }),
              names(good(), i, "mean the previous position"));
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[i].params[6] = 0.0; }),
              names(good(), i, "height 0"));
}

TEST_P(MissionInterpreter, FollowsJumps) {
  // Jumps twice from the last capture point back to the first, through the building.
  const std::size_t end = find_index(good(), command::land) - 1;
  const auto jump_to = [&](double number, double repeats) {
    return after([&](MavlinkMission& f) {
      f.items.insert(f.items.begin() + static_cast<std::ptrdiff_t>(end),
                     {command::jump, frame::mission, {number, repeats, 0, 0, 0, 0, 0}, true, 999});
    });
  };
  const auto second = static_cast<double>(good().items[find_waypoint(good(), 1)].number);
  EXPECT_THAT(jump_to(second, 2), Contains(HasSubstr("leg from item")));
  EXPECT_THAT(jump_to(second, 0), IsEmpty());
  EXPECT_THAT(jump_to(second, -1), Contains(HasSubstr("item 999 jumps -1.0 times")));
  EXPECT_THAT(jump_to(500, 1), Contains(HasSubstr("item 999 jumps to an item that does not")));
}

TEST_P(MissionInterpreter, RejectsChangedFenceAndRallyPoints) {
  if (GetParam() == AutopilotType::ardupilot) {
    // .waypoints files cannot contain a fence. Only the route is checked.
    EXPECT_FALSE(good().supports_fence);
    return;
  }
  EXPECT_THAT(
      after([](MavlinkMission& f) { f.fence.clear(); }),
      AllOf(Contains(HasSubstr("does not contain the mission's fence \"site\"")),
            Contains(HasSubstr("does not contain the mission's no-fly volume \"heliport\""))));
  EXPECT_THAT(after([](MavlinkMission& f) { f.fence[0].corners[1].latitude_deg += 1e-5; }),
              Contains(HasSubstr("does not contain the mission's fence")));
  EXPECT_THAT(after([](MavlinkMission& f) {
                std::reverse(f.fence[0].corners.begin(), f.fence[0].corners.end());
                std::rotate(f.fence[0].corners.begin(), f.fence[0].corners.begin() + 1,
                            f.fence[0].corners.end());
              }),
              IsEmpty());
  EXPECT_THAT(
      after([](MavlinkMission& f) { f.fence[0].is_inclusion = false; }),
      Contains(AllOf(HasSubstr("leg from item"), HasSubstr("enters geoFence.polygons[0]"))));
  EXPECT_THAT(after([](MavlinkMission& f) { f.fence[1].is_inclusion = true; }),
              Contains(HasSubstr("leaves geoFence.polygons[1]")));
  EXPECT_THAT(after([](MavlinkMission& f) {
                f.rally = {{51.75, -1.25, 0}};
              }),
              Contains(HasSubstr("rallyPoints.points[0] is not in the mission's")));
}

// The vehicle returns to the nearest rally point, so the file must contain the verified ones.
TEST_P(MissionInterpreter, RejectsMissingOrRaisedRallyPoints) {
  FlightFacts facts = sample_facts(GetParam());
  facts.rally = {{35, 35, 0}};
  const GeodeticPoint position = position_at({35, 35, 0});
  const auto with = [&](std::vector<GeodeticPoint> rally) {
    MavlinkMission file = good();
    file.rally = std::move(rally);
    return interpret(file, facts).problems;
  };
  EXPECT_THAT(with({{position.latitude_deg, position.longitude_deg, 0.0}}), IsEmpty());
  EXPECT_THAT(with({{position.latitude_deg, position.longitude_deg, 15.0}}),
              Contains(HasSubstr("points[0] is 15.0 m above home")));
  EXPECT_THAT(with({}), Contains(HasSubstr("does not contain 1 of the mission's 1 rally points")));
}

TEST_P(MissionInterpreter, RejectsItemsThatAreNotExecuted) {
  EXPECT_THAT(after([](MavlinkMission& f) { f.items[2].auto_continue = false; }),
              names(good(), 2, "does not continue"));
  EXPECT_THAT(after([](MavlinkMission& f) { f.items.push_back(f.items[2]); }),
              names(good(), 2, "after the landing"));
  const std::size_t end = find_index(good(), command::land);
  EXPECT_THAT(after([&](MavlinkMission& f) { f.items[end].command = command::delay; }),
              Not(IsEmpty()));
  const auto waiting = [&](double seconds) {
    return after([&](MavlinkMission& f) {
      f.items.insert(f.items.begin() + static_cast<std::ptrdiff_t>(end),
                     {command::delay, frame::mission, {seconds, -1, -1, -1, 0, 0, 0}, true, 999});
    });
  };
  EXPECT_THAT(waiting(0.5), IsEmpty());
  EXPECT_THAT(waiting(-1), Contains(HasSubstr("item 999 (command 93) waits for -1.0 s")));
}

// A corner without a stop is cut. The triangle of its two legs must be free.
TEST_P(MissionInterpreter, VerifiesCornersWithoutStopAsTriangles) {
  const auto rounded = [&](const Eigen::Vector3d& corner) {
    MavlinkMission file = good();
    file.items.resize(2);
    const auto add = [&](const Eigen::Vector3d& position, double hold) {
      const double radius = hold > 0.0 ? 0.3 : 100.0;  // PX4 turns within the radius.
      MissionItem item{command::waypoint, frame::relative, {hold, radius, 0, 0, 0, 0, 0}, true, 0};
      item.number = file.items.back().number + 1;
      move(item, position);
      file.items.push_back(item);
    };
    add({-20, -25, 8}, 1.0);
    add(corner, 0.0);
    add({-20, 25, 8}, 1.0);
    add({-30, -25, 8}, 1.0);
    MissionItem landing = good().items[find_index(good(), command::land)];
    landing.number = file.items.back().number + 1;
    file.items.push_back(landing);
    FlightFacts facts = sample_facts(GetParam());
    return find_problems(interpret(file, facts));
  };
  EXPECT_THAT(rounded({-40, 0, 8}), IsEmpty());
  EXPECT_THAT(rounded({-13, 0, 8}), IsEmpty());
  // Around the corner through a point far in the east: both legs are free, but their triangle is
  // not.
  const Eigen::Vector3d corner(27, -13, 34);
  EXPECT_THAT(check_route({{-20, -25, 8}, corner, {-20, 25, 8}}, KnownSpace(sample_site()), 2.0),
              IsEmpty());
  EXPECT_THAT(rounded(corner), Contains(HasSubstr("leg from item")));
}

// Waypoints around a corner of the building, 3 m from its sides. ArduPilot blends legs from their
// middle, PX4 turns within the acceptance radius.
TEST_P(MissionInterpreter, VerifiesChainsOfCornersWithoutStop) {
  const auto around = [&](double step, double radius) {
    MavlinkMission file = good();
    file.items.resize(2);
    const auto add = [&](const Eigen::Vector3d& position, double hold) {
      MissionItem item{command::waypoint, frame::relative, {hold, radius, 0, 0, 0, 0, 0}, true, 0};
      item.number = file.items.back().number + 1;
      move(item, position);
      file.items.push_back(item);
    };
    add({-30, 5, 8}, 1.0);
    for (double y = 5; y > -13; y -= step) add({-13, y, 8}, 0.0);
    for (double x = -13; x <= 5; x += step) add({x, -13, 8}, 0.0);
    add({5, -20, 8}, 1.0);
    add({-30, -25, 8}, 1.0);
    MissionItem landing = good().items[find_index(good(), command::land)];
    landing.number = file.items.back().number + 1;
    file.items.push_back(landing);
    FlightFacts facts = sample_facts(GetParam());
    return find_problems(interpret(file, facts));
  };
  const bool is_px4 = GetParam() == AutopilotType::px4;
  EXPECT_THAT(around(1.0, 0.3), IsEmpty());
  EXPECT_THAT(around(18.0, 0.3).empty(), is_px4);
  EXPECT_THAT(around(18.0, 12.0), Contains(HasSubstr("leg from item")));
}

// PX4 accepts a waypoint within the radius horizontally and within 0.8 m vertically.
TEST(Px4TurnDistance, IsLargerOnSteepLegs) {
  EXPECT_DOUBLE_EQ(px4_turn_distance({10, 0, 0}, 0.3), 0.3);
  EXPECT_DOUBLE_EQ(px4_turn_distance({0, 0, -10}, 0.3), 0.8);
  EXPECT_DOUBLE_EQ(px4_turn_distance({3, 0, 4}, 0.3), 0.5);
  EXPECT_DOUBLE_EQ(px4_turn_distance({0.3, 0, 4}, 0.3), 0.8 * std::hypot(0.3, 4.0) / 4.0);
  EXPECT_DOUBLE_EQ(px4_turn_distance({0, 0, 0.5}, 0.3), 0.5);
  EXPECT_DOUBLE_EQ(px4_turn_distance({30, 0, 40}, 20.0), 20.0);
  EXPECT_EQ(px4_turn_distance({0, 0, 0}, 0.0), 0.0);
}

// A leg that starts beside its line ends beside it, too, but nearer.
TEST(DepartureAfter, CarriesPartOfTheOffset) {
  InterpretedSegment leg{{{0, 1, 0}, {0, 0, 0}}, {10, 0, 0}, "item 1", "item 2"};
  const Departure departure = departure_after(leg, 2.0);
  EXPECT_LT((departure.start.from - Eigen::Vector3d(8, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(departure.start.to, leg.to);
  EXPECT_NEAR(departure.margin, 0.2, 1e-12);
  leg.margin = 0.5;
  EXPECT_NEAR(departure_after(leg, 2.0).margin, 0.3, 1e-12);
  EXPECT_EQ(departure_after(leg, 99.0).start.from, Eigen::Vector3d(0, 0, 0));
}

TEST(Interpreter, AcceptsDelayInsteadOfHoldForArduPilot) {
  MavlinkMission file = sample_file(AutopilotType::ardupilot);
  const std::size_t waypoint_index = find_waypoint(file);
  file.items[waypoint_index].params[0] = 0.0;
  const MissionItem delay{command::delay, frame::mission, {4.0, -1, -1, -1, 0, 0, 0}, true, 999};
  file.items.insert(file.items.begin() + static_cast<std::ptrdiff_t>(waypoint_index) + 1, delay);
  EXPECT_THAT(find_problems(file, AutopilotType::ardupilot), IsEmpty());
}

TEST(Interpreter, ReportsFileForOtherAutopilot) {
  EXPECT_THAT(find_problems(sample_file(AutopilotType::px4), AutopilotType::ardupilot),
              Contains(HasSubstr("written for PX4; vehicle \"generic_ardupilot\"")));
}

TEST(ItemOrder, UnrollsJumps) {
  const auto item = [](int command, std::size_t number, double to = 0, double times = 0) {
    return MissionItem{command, frame::mission, {to, times}, true, number};
  };
  const std::vector<MissionItem> items = {item(22, 1), item(16, 2), item(16, 3), item(177, 4, 2, 2),
                                          item(21, 5)};
  EXPECT_THAT(compute_order(items).indices, ElementsAre(0, 1, 2, 1, 2, 1, 2, 4));
  const std::vector<MissionItem> nested = {item(16, 1), item(177, 2, 1, 20), item(177, 3, 1, 20),
                                           item(177, 4, 1, 20)};
  EXPECT_THAT(compute_order(nested).problems, ElementsAre(HasSubstr("ten times as long")));
}

// Property: all legs in a verified fan keep the clearance.
TEST(InterpretedRoute, KeepsClearanceOnAllLegsOfVerifiedFan) {
  const KnownSpace space(sample_site());
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> level(-30, 30), height(3, 25);
  int verified = 0, rejected = 0;
  for (int i = 0; i < 300; ++i) {
    const auto position = [&] {
      return Eigen::Vector3d{level(random), level(random), height(random)};
    };
    InterpretedRoute route;
    route.segments.push_back({{position(), position()}, position(), "item 1", "item 2"});
    const InterpretedSegment& segment = route.segments.front();
    double min = 10.0;
    for (int k = 0; k <= 200; ++k) {
      min = std::min(min, space.closest({segment.start.at(k / 200.0), segment.to}, 10.0).distance);
    }
    const RouteVerification verification = verify(route, space, space, 2.0, 10.0);
    if (verification.problems.empty()) {
      ++verified;
      EXPECT_GE(min, 2.0);
      EXPECT_GE(min, verification.clearance - 1e-9);
    } else {
      ++rejected;
      EXPECT_LT(min, 2.0 + 0.5 * segment.start.length() / 200.0 + 0.01);
    }
  }
  EXPECT_GT(verified, 30);
  EXPECT_GT(rejected, 30);
}

}  // namespace
}  // namespace skycap::flight
