// What autopilots do with spoiled missions: every kind that a review found to pass as "fine" is
// refused by its item, or proven as it is flown.
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

class BothAutopilots : public testing::TestWithParam<Dialect> {
 protected:
  MissionFile good() const { return sample_file(GetParam()); }  // namespace
  Problems after(const std::function<void(MissionFile&)>& change) const {
    MissionFile file = good();
    change(file);
    return problems_of(file, GetParam());
  }
  /// The problem names the item of that index, by its number.
  static auto names(const MissionFile& file, std::size_t index, const std::string& what) {
    return Contains(AllOf(testing::StartsWith(name_of(file.items[index]) + " "), HasSubstr(what)));
  }
};

INSTANTIATE_TEST_SUITE_P(Interpreter, BothAutopilots,
                         testing::Values(Dialect::px4, Dialect::ardupilot),
                         [](const auto& parameter) {
                           return parameter.param == Dialect::px4 ? "px4" : "ardupilot";
                         });

TEST_P(BothAutopilots, OurOwnFilesAreFine) {
  EXPECT_THAT(problems_of(good(), GetParam()), IsEmpty());
}

// The promise of the table: whatever is not in it is refused by its item.
TEST_P(BothAutopilots, EveryUnknownCommandIsRefused) {
  const MissionFile file = good();
  MissionFile spoiled = file;
  const std::size_t i = index_of(file, command::waypoint, 1);
  const FlightFacts facts = sample_facts(GetParam());
  for (int id = 0; id < 65536; ++id) {
    if (find_command(id) != nullptr) continue;
    spoiled.items[i].command = id;
    const Problems problems = interpret(spoiled, facts).problems;
    ASSERT_THAT(problems, Contains(name_of(file.items[i]) + " (command " + std::to_string(id) +
                                   ") is an unsupported command; remove it"));
  }
}

TEST_P(BothAutopilots, CommandsThatAreNotFlownOrNotProvenAreRefused) {
  int refused = 0;
  for (int id = 0; id < 65536; ++id) {
    const CommandRow* const row = find_command(id);
    if (row == nullptr || row->meaning != Meaning::refused) continue;
    ++refused;
    const std::size_t i = index_of(good(), command::waypoint, 1);
    EXPECT_THAT(after([&](MissionFile& f) { f.items[i].command = id; }),
                names(good(), i, row->name));
  }
  EXPECT_GT(refused, 10);
}

TEST_P(BothAutopilots, ALoiterInTheWallIsFlownTo) {
  const std::size_t i = index_of(good(), command::waypoint, 1);
  EXPECT_THAT(after([&](MissionFile& f) {
                f.items[i].command = command::loiter_time;
                move(f.items[i], {-9.5, 0, 8});
              }),
              Contains(AllOf(HasSubstr("leg from "), HasSubstr(name_of(good().items[i])),
                             HasSubstr("0.00 m from "))));
}

TEST_P(BothAutopilots, LandingsAreOnThePadOrRefused) {
  const std::size_t i = index_of(good(), command::land);
  const auto landing_at = [&](const Eigen::Vector3d& place) {
    return after([&](MissionFile& f) { move(f.items[i], place); });
  };
  EXPECT_THAT(landing_at({0, 0, 0}), names(good(), i, "m from the take-off point"));
  EXPECT_THAT(landing_at({0, 0, 0}), Contains(HasSubstr("leg from item")));
  EXPECT_THAT(landing_at({-30, 25, 0}), names(good(), i, "lands 50.0 m from the take-off point"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[i].command = command::return_to_launch; }),
              names(good(), i, "RETURN_TO_LAUNCH"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[i - 1].command = command::return_to_launch; }),
              names(good(), i - 1, "RETURN_TO_LAUNCH"));
  // A landing in mid-route ends the flight there.
  const std::size_t middle = index_of(good(), command::waypoint, 2);
  EXPECT_THAT(after([&](MissionFile& f) { f.items[middle].command = command::land; }),
              AllOf(names(good(), middle, "m from the take-off point"),
                    names(good(), middle + 1, "after the landing")));
}

TEST_P(BothAutopilots, HoldsRadiiAndSpeedsAreTheMissions) {
  const std::size_t station = station_of(good()), hold = hold_of(good());
  EXPECT_THAT(after([&](MissionFile& f) {
                f.items[station].params[0] = 0.0;
                if (hold != station) {
                  f.items.erase(f.items.begin() + static_cast<std::ptrdiff_t>(hold));
                }
              }),
              Not(IsEmpty()));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[hold].params[0] = 1.0; }),
              names(good(), station, "holds 1.00 s before its image"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[station].params[1] = 20.0; }),
              Contains(HasSubstr("captures an image where the vehicle does not stop")));
  const std::size_t speed = index_of(good(), command::change_speed);
  EXPECT_THAT(after([&](MissionFile& f) { f.items[speed].params[1] = 15.0; }),
              names(good(), speed, "sets 15.00 m/s"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[speed].params[1] = -1.0; }),
              names(good(), speed, "sets -1.00 m/s"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[speed].params[0] = 4.0; }),
              names(good(), speed, "speed type"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items.erase(f.items.begin() + speed); }),
              Contains(HasSubstr("no item before it sets the speed")));
}

TEST_P(BothAutopilots, PhotographsLookWhereTheViewsDo) {
  const bool is_px4 = GetParam() == Dialect::px4;
  const std::size_t station = station_of(good());
  const std::size_t yaw = is_px4 ? station : index_of(good(), command::condition_yaw);
  const std::size_t field = is_px4 ? 3 : 0;
  EXPECT_THAT(after([&](MissionFile& f) {
                double& heading = f.items[yaw].params[field];
                heading = std::fmod(heading + 90.0, 360.0);
              }),
              names(good(), station, "degrees beside its view"));
  const std::size_t mount = index_of(good(), command::mount_control);
  EXPECT_THAT(after([&](MissionFile& f) { f.items[mount].params[0] -= 3.0; }),
              names(good(), station, "degrees beside its view"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[mount].params[0] = -100.0; }),
              names(good(), station, "cannot"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[mount].params[6] = 3.0; }),
              names(good(), mount, "must aim by angles"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[station].params[6] += 0.5; }),
              names(good(), station, "away from all views of the mission"));
}

TEST_P(BothAutopilots, HomeIsThePad) {
  EXPECT_THAT(
      after([](MissionFile& f) { f.home->height += 30.0; }),
      Contains(AllOf(HasSubstr(sample_file(GetParam()).home_name), HasSubstr("30.0 m above"))));
  EXPECT_THAT(after([](MissionFile& f) { f.home->latitude_deg += 60.0 / 111250.0; }),
              Contains(HasSubstr("m from the take-off point")));
  const std::size_t i = index_of(good(), command::takeoff);
  EXPECT_THAT(after([&](MissionFile& f) {
                move(f.items[i], {-30, 0, 5});
              }),
              names(good(), i, "takes off 25.0 m from the mission's take-off point"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[i].params[6] = -1.0; }),
              names(good(), i, "not above the take-off point"));
}

// One item above sea level says nothing of the others.
TEST_P(BothAutopilots, HeightsCountItemByItem) {
  const std::size_t i = index_of(good(), command::waypoint, 1);
  const double pad_amsl = 111.5 - 46.7;
  EXPECT_THAT(after([&](MissionFile& f) {
                f.items[i].frame = frame::global;
                f.items[i].params[6] += pad_amsl;
              }),
              IsEmpty());
  EXPECT_THAT(after([&](MissionFile& f) { f.items[i].frame = frame::global; }),
              Contains(HasSubstr("leg from item")));
  EXPECT_THAT(after([&](MissionFile& f) {
                f.items[i].frame = frame::global;
                f.items[i].params[6] += pad_amsl;
                move(f.items[station_of(f, 1)], {-9.5, 0, 8});
              }),
              Not(IsEmpty()));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[i].frame = frame::terrain; }),
              names(good(), i, "frame 10"));
  MissionFile file = good();
  file.items[i].frame = frame::global;
  FlightFacts facts = sample_facts(GetParam());
  facts.site.geoid_undulation.reset();
  EXPECT_THAT(testing_support::complaint_of([&] { interpret(file, facts); }),
              testing::HasSubstr(", above sea level, requires"));
}

TEST_P(BothAutopilots, PlacesThatMeanAsBeforeAreRefused) {
  const std::size_t i = index_of(good(), command::waypoint, 1);
  EXPECT_THAT(after([&](MissionFile& f) { f.items[i].params[4] = f.items[i].params[5] = 0.0; }),
              names(good(), i, "as before"));
  EXPECT_THAT(after([&](MissionFile& f) { f.items[i].params[6] = 0.0; }),
              names(good(), i, "height 0"));
}

TEST_P(BothAutopilots, JumpsAreFlown) {
  // Back from the last station to the first, through the building, twice.
  const std::size_t end = index_of(good(), command::land) - 1;
  const auto jump_to = [&](double number, double repeats) {
    return after([&](MissionFile& f) {
      f.items.insert(f.items.begin() + static_cast<std::ptrdiff_t>(end),
                     {command::jump, frame::mission, {number, repeats, 0, 0, 0, 0, 0}, true, 999});
    });
  };
  const auto second = static_cast<double>(good().items[station_of(good(), 1)].number);
  EXPECT_THAT(jump_to(second, 2), Contains(HasSubstr("leg from item")));
  EXPECT_THAT(jump_to(second, 0), IsEmpty());
  EXPECT_THAT(jump_to(second, -1), Contains(HasSubstr("item 999 jumps -1.0 times")));
  EXPECT_THAT(jump_to(500, 1), Contains(HasSubstr("item 999 jumps to an item that does not")));
}

TEST_P(BothAutopilots, FenceAndRallyPointsAreTheMissions) {
  if (GetParam() == Dialect::ardupilot) {
    // .waypoints hold no fence: the route alone is judged.
    EXPECT_FALSE(good().holds_fence);
    return;
  }
  EXPECT_THAT(
      after([](MissionFile& f) { f.fence.clear(); }),
      AllOf(Contains(HasSubstr("does not contain the mission's fence \"site\"")),
            Contains(HasSubstr("does not contain the mission's no-fly volume \"heliport\""))));
  EXPECT_THAT(after([](MissionFile& f) { f.fence[0].corners[1].latitude_deg += 1e-5; }),
              Contains(HasSubstr("does not contain the mission's fence")));
  EXPECT_THAT(after([](MissionFile& f) {
                std::reverse(f.fence[0].corners.begin(), f.fence[0].corners.end());
                std::rotate(f.fence[0].corners.begin(), f.fence[0].corners.begin() + 1,
                            f.fence[0].corners.end());
              }),
              IsEmpty());
  EXPECT_THAT(
      after([](MissionFile& f) { f.fence[0].is_inclusion = false; }),
      Contains(AllOf(HasSubstr("leg from item"), HasSubstr("enters geoFence.polygons[0]"))));
  EXPECT_THAT(after([](MissionFile& f) { f.fence[1].is_inclusion = true; }),
              Contains(HasSubstr("leaves geoFence.polygons[1]")));
  EXPECT_THAT(after([](MissionFile& f) {
                f.rally = {{51.75, -1.25, 0}};
              }),
              Contains(HasSubstr("rallyPoints.points[0] is not in the mission's")));
}

// Returns go to the nearest place to land, so the file must hold those that are proven.
TEST_P(BothAutopilots, RallyPointsAreTheMissions) {
  FlightFacts facts = sample_facts(GetParam());
  facts.rally = {{35, 35, 0}};
  const GeodeticPoint place = place_at({35, 35, 0});
  const auto with = [&](std::vector<GeodeticPoint> rally) {
    MissionFile file = good();
    file.rally = std::move(rally);
    return interpret(file, facts).problems;
  };
  EXPECT_THAT(with({{place.latitude_deg, place.longitude_deg, 0.0}}), IsEmpty());
  EXPECT_THAT(with({{place.latitude_deg, place.longitude_deg, 15.0}}),
              Contains(HasSubstr("points[0] is 15.0 m above home")));
  EXPECT_THAT(with({}), Contains(HasSubstr("does not contain 1 of the mission's 1 rally points")));
}

TEST_P(BothAutopilots, WhatFollowsMustBeFlown) {
  EXPECT_THAT(after([](MissionFile& f) { f.items[2].auto_continue = false; }),
              names(good(), 2, "does not continue"));
  EXPECT_THAT(after([](MissionFile& f) { f.items.push_back(f.items[2]); }),
              names(good(), 2, "after the landing"));
  const std::size_t end = index_of(good(), command::land);
  EXPECT_THAT(after([&](MissionFile& f) { f.items[end].command = command::delay; }),
              Not(IsEmpty()));
  const auto waiting = [&](double seconds) {
    return after([&](MissionFile& f) {
      f.items.insert(f.items.begin() + static_cast<std::ptrdiff_t>(end),
                     {command::delay, frame::mission, {seconds, -1, -1, -1, 0, 0, 0}, true, 999});
    });
  };
  EXPECT_THAT(waiting(0.5), IsEmpty());
  EXPECT_THAT(waiting(-1), Contains(HasSubstr("item 999 (command 93) waits for -1.0 s")));
}

// A corner without a stop is cut: the triangle of its two legs must be free.
TEST_P(BothAutopilots, CornersWithoutAStopAreProvenAsTriangles) {
  const auto flown_round = [&](const Eigen::Vector3d& corner) {
    MissionFile file = good();
    file.items.resize(2);
    const auto add = [&](const Eigen::Vector3d& place, double hold) {
      MissionItem item{command::waypoint, frame::relative, {hold, 0.3, 0, 0, 0, 0, 0}, true, 0};
      item.number = file.items.back().number + 1;
      move(item, place);
      file.items.push_back(item);
    };
    add({-20, -25, 8}, 1.0);
    add(corner, 0.0);
    add({-20, 25, 8}, 1.0);
    add({-30, -25, 8}, 1.0);
    MissionItem landing = good().items[index_of(good(), command::land)];
    landing.number = file.items.back().number + 1;
    file.items.push_back(landing);
    FlightFacts facts = sample_facts(GetParam());
    return problems_of(interpret(file, facts));
  };
  EXPECT_THAT(flown_round({-40, 0, 8}), IsEmpty());
  EXPECT_THAT(flown_round({-13, 0, 8}), IsEmpty());
  // Round the corner by a point far out to the east: both legs are free, their triangle is not.
  const Eigen::Vector3d corner(27, -13, 34);
  EXPECT_THAT(check_route({{-20, -25, 8}, corner, {-20, 25, 8}}, KnownSpace(sample_site()), 2.0),
              IsEmpty());
  EXPECT_THAT(flown_round(corner), Contains(HasSubstr("leg from item")));
}

TEST(Interpreter, ArduPilotStopsWithoutAHoldBeforeADelay) {
  MissionFile file = sample_file(Dialect::ardupilot);
  const std::size_t station = station_of(file);
  file.items[station].params[0] = 0.0;
  const MissionItem delay{command::delay, frame::mission, {4.0, -1, -1, -1, 0, 0, 0}, true, 999};
  file.items.insert(file.items.begin() + static_cast<std::ptrdiff_t>(station) + 1, delay);
  EXPECT_THAT(problems_of(file, Dialect::ardupilot), IsEmpty());
}

TEST(Interpreter, AFileForTheOtherAutopilotIsSaid) {
  EXPECT_THAT(problems_of(sample_file(Dialect::px4), Dialect::ardupilot),
              Contains(HasSubstr("written for PX4; vehicle \"generic_ardupilot\"")));
}

TEST(ItemOrder, JumpsAreUnrolled) {
  const auto item = [](int command, std::size_t number, double to = 0, double times = 0) {
    return MissionItem{command, frame::mission, {to, times}, true, number};
  };
  const std::vector<MissionItem> items = {item(22, 1), item(16, 2), item(16, 3), item(177, 4, 2, 2),
                                          item(21, 5)};
  EXPECT_THAT(order_of(items).indices, ElementsAre(0, 1, 2, 1, 2, 1, 2, 4));
  const std::vector<MissionItem> nested = {item(16, 1), item(177, 2, 1, 20), item(177, 3, 1, 20),
                                           item(177, 4, 1, 20)};
  EXPECT_THAT(order_of(nested).problems, ElementsAre(HasSubstr("ten times as long")));
}

// Property: a fan that is proven keeps its clearance on every one of its legs.
TEST(FlownRoute, AProvenFanIsFreeEverywhere) {
  const KnownSpace space(sample_site());
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> level(-30, 30), height(3, 25);
  int proven = 0, refused = 0;
  for (int i = 0; i < 300; ++i) {
    const auto place = [&] {
      return Eigen::Vector3d{level(random), level(random), height(random)};
    };
    FlownRoute route;
    route.pieces.push_back({{place(), place()}, place(), "item 1", "item 2"});
    const FlownPiece& piece = route.pieces.front();
    double least = 10.0;
    for (int k = 0; k <= 200; ++k) {
      least = std::min(least, space.closest({piece.start.at(k / 200.0), piece.to}, 10.0).distance);
    }
    const FlownProof proof = prove(route, space, space, 2.0, 10.0);
    if (proof.problems.empty()) {
      ++proven;
      EXPECT_GE(least, 2.0);
      EXPECT_GE(least, proof.clearance - 1e-9);
    } else {
      ++refused;
      EXPECT_LT(least, 2.0 + 0.5 * piece.start.length() / 200.0 + 0.01);
    }
  }
  EXPECT_GT(proven, 30);
  EXPECT_GT(refused, 30);
}

}  // namespace
}  // namespace skycap::flight
