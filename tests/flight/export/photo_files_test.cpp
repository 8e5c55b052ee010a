// Missions with a photo camera: the file contains each planned photo at its position and with its
// direction, at stops and in runs. The camera's minimum interval is respected.
#include <algorithm>
#include <filesystem>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/map_files.h"
#include "flight/export/mavlink_files.h"
#include "flight/export/photo_runs.h"
#include "flight/export/wpml_file.h"
#include "flight/interpreter/interpret.h"
#include "flight/interpreter/mission_interpreter.h"
#include "flight/interpreter/photographs.h"
#include "flight/interpreter/verified_export.h"
#include "flight/interpreter/wpml_interpreter.h"
#include "tests/flight/export/sample_plan.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

Vehicle mavic_3e() {
  Vehicle vehicle = vehicle_profile("m30t");
  vehicle.name = "mavic_3e";
  vehicle.wpml = {77, 0, 66, "1.0.6"};
  return vehicle;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << "nothing to replace: " << from;
  return position == std::string::npos ? text : text.replace(position, from.size(), to);
}

struct FileCase {
  Format format;
  std::string vehicle;  ///< test vehicle
};

class PhotoFiles : public testing::TestWithParam<FileCase> {
 protected:
  FlightPlan stops() const { return photo_row_plan(vehicle_profile(GetParam().vehicle)); }
  InterpretedRoute flight_record(const FlightPlan& plan) const {
    return interpret(write(plan, GetParam().format), GetParam().format, make_flight_facts(plan));
  }
};

INSTANTIATE_TEST_SUITE_P(Export, PhotoFiles,
                         testing::Values(FileCase{Format::kmz, "m350_rtk"},
                                         FileCase{Format::kmz, "m30t"},
                                         FileCase{Format::plan, "generic"},
                                         FileCase{Format::waypoints, "generic_ardupilot"},
                                         FileCase{Format::litchi, "generic"}),
                         [](const auto& parameter) {
                           return std::string(format_info(parameter.param.format).name) + "_" +
                                  parameter.param.vehicle;
                         });

TEST_P(PhotoFiles, CaptureEveryPhotoAtItsStop) {
  const FlightPlan plan = stops();
  const std::string content = write(plan, GetParam().format);
  EXPECT_THAT(validate(content, GetParam().format), IsEmpty());
  const InterpretedRoute route = flight_record(plan);
  EXPECT_THAT(route.problems, IsEmpty());
  EXPECT_THAT(missing_photographs(route, make_flight_facts(plan)), IsEmpty());
  ASSERT_EQ(route.stops.size(), 6U);
  EXPECT_THAT(route.is_fly_through, IsEmpty());
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_LT(
        (route.stops[i].position - Vector3d(3.0 * static_cast<double>(i) - 7.5, -16, 8)).norm(),
        0.02);
    EXPECT_NEAR(route.stops[i].yaw_deg, 0.0, 1e-4);
    EXPECT_NEAR(route.stops[i].pitch_deg, 0.0, 1e-4);
    EXPECT_EQ(route.stops[i].captures, 1);
  }
}

// The first and the last photo are taken at stops, the four photos between them in flight.
TEST_P(PhotoFiles, CaptureEveryPhotoOfARun) {
  if (!holds_photo_runs(GetParam().format)) GTEST_SKIP() << "the format has no distance trigger";
  const FlightPlan plan = with_photo_runs(stops());
  ASSERT_EQ(photos_in_runs(plan), 4U);
  EXPECT_THAT(validate(write(plan, GetParam().format), GetParam().format), IsEmpty());
  const InterpretedRoute route = flight_record(plan);
  EXPECT_THAT(route.problems, IsEmpty());
  EXPECT_THAT(missing_photographs(route, make_flight_facts(plan)), IsEmpty());
  ASSERT_EQ(route.stops.size(), 2U);
  ASSERT_EQ(route.is_fly_through.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const FlownPass& pass = route.is_fly_through[i];
    EXPECT_LT((pass.position - Vector3d(3.0 * static_cast<double>(i) - 4.5, -16, 8)).norm(), 0.02);
    EXPECT_NEAR(pass.yaw_deg, 0.0, 1e-4);
    EXPECT_NEAR(pass.pitch_deg, 0.0, 1e-4);
    EXPECT_NEAR(pass.speed, 2.5, 1e-9) << "the limit of motion blur";
    EXPECT_EQ(pass.stops_before, 1U);
  }
  EXPECT_LT(flight_time(plan), flight_time(stops()) - 4.0);
}

TEST_P(PhotoFiles, AreVerifiedAgainBeforeTheyGetTheirNames) {
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) /
      ("photo_row_" + GetParam().vehicle + format_info(GetParam().format).extension);
  const FlightPlan plan = holds_photo_runs(GetParam().format) ? with_photo_runs(stops()) : stops();
  EXPECT_GE(export_flight(plan, GetParam().format, KnownSpace(sample_site()), path).min_clearance,
            plan.clearance - rounding_bound);
  std::filesystem::remove(path);
  // A photo missing from the file is detected.
  FlightFacts facts = make_flight_facts(plan);
  facts.views.push_back({{0, -18, 8}, Vector3d::UnitY()});
  EXPECT_THAT(missing_photographs(flight_record(plan), facts),
              testing::ElementsAre(HasSubstr("(0.00, -18.00, 8.00)")));
}

TEST_P(PhotoFiles, AreNoFasterThanTheCamera) {
  FlightPlan plan = holds_photo_runs(GetParam().format) ? with_photo_runs(stops()) : stops();
  FlightFacts facts = make_flight_facts(plan);
  const auto problems = [&] {
    return interpret(write(plan, GetParam().format), GetParam().format, facts).problems;
  };
  EXPECT_THAT(problems(), IsEmpty());
  facts.photo->min_interval = 20.0;
  EXPECT_THAT(problems(), Contains(HasSubstr("the camera's minimum interval is 20.00 s")));
  if (!holds_photo_runs(GetParam().format)) return;
  facts.photo->min_interval = 0.7;
  facts.photo->exposure = 0.002;
  EXPECT_THAT(problems(), Contains(HasSubstr("at 2.50 m/s; it must be at most 1.25 m/s (motion "
                                             "blur)")));
  facts.photo->exposure = 0.001;
  facts.photo->readout = 0.01;
  EXPECT_THAT(problems(), Contains(HasSubstr("at most 0.50 m/s (rolling shutter)")));
}

// Property: photos that are unevenly spaced, off the line or in other directions are taken at
// stops.
TEST(PhotoRuns, AreStraightEvenAndOfOneAim) {
  const FlightPlan plan = photo_row_plan(vehicle_profile("generic"));
  const std::size_t first = 1;  // Index 0 is above the pad.
  std::size_t capture_point = first;
  while (!plan.waypoints[capture_point].is_capture_point) ++capture_point;
  const auto changed = [&](const std::function<void(Waypoint&)>& change, std::size_t i) {
    FlightPlan other = plan;
    change(other.waypoints[capture_point + i]);
    return photos_in_runs(with_photo_runs(other));
  };
  EXPECT_EQ(photos_in_runs(with_photo_runs(plan)), 4U);
  EXPECT_EQ(changed([](Waypoint& w) { w.position.x() += 0.2; }, 2), 4U) << "even within 10%";
  EXPECT_EQ(changed([](Waypoint& w) { w.position.x() += 1.0; }, 2), 1U) << "3 m from the fourth on";
  EXPECT_EQ(changed([](Waypoint& w) { w.position.y() -= 0.1; }, 5), 3U) << "bent at the fifth";
  EXPECT_EQ(changed([](Waypoint& w) { w.pitch = -0.1; }, 3), 1U) << "another aim in the middle";
  EXPECT_EQ(changed([](Waypoint& w) { w.captures = 2; }, 3), 1U);
  FlightPlan slow = plan;
  slow.photo->exposure = 0.02;  // Maximum speed 0.125 m/s.
  EXPECT_EQ(photos_in_runs(with_photo_runs(slow)), 0U);
  FlightPlan unknown = plan;
  unknown.photo.reset();
  EXPECT_EQ(photos_in_runs(with_photo_runs(unknown)), 0U);
}

// As in DJI's table for this action. The gimbal uses the vehicle heading.
TEST(PhotoWpml, OrientedShootsWhereTheVehicleHasThem) {
  const FlightPlan plan = photo_row_plan(mavic_3e());
  const KmzContent kmz = unpack_kmz(write_kmz(plan));
  const auto count = [](const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (std::size_t i = text.find(what); i != std::string::npos; i = text.find(what, i + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count(kmz.waylines_wpml, ">orientedShoot<"), 6U);
  EXPECT_EQ(count(kmz.waylines_wpml, ">takePhoto<"), 0U);
  EXPECT_EQ(count(kmz.waylines_wpml, "<wpml:payloadLensIndex>visable<"), 6U);
  EXPECT_EQ(count(kmz.waylines_wpml, "<wpml:orientedCameraType>66<"), 6U);
  EXPECT_EQ(count(kmz.template_kml, "<wpml:imageFormat>visable<"), 1U);

  const FlightPlan mounted = photo_row_plan(vehicle_profile("m350_rtk"));
  EXPECT_EQ(count(unpack_kmz(write_kmz(mounted)).waylines_wpml, ">takePhoto<"), 6U);

  const auto after = [&](const std::string& from, const std::string& to) {
    return interpret({kmz.template_kml, replaced(kmz.waylines_wpml, from, to)},
                     make_flight_facts(plan))
        .problems;
  };
  EXPECT_THAT(after("<wpml:aircraftHeading>0.0000", "<wpml:aircraftHeading>15.0000"),
              Contains(HasSubstr("they must be equal")));
  EXPECT_THAT(after("<wpml:accurateFrameValid>0", "<wpml:accurateFrameValid>1"),
              Contains(HasSubstr("searches for")));
}

TEST(PhotoWpml, WritesTheCarriedPayload) {
  FlightPlan plan = photo_row_plan(vehicle_profile("m350_rtk"));
  plan.photo->payload = 50;  // Zenmuse P1
  const KmzContent kmz = unpack_kmz(write_kmz(plan));
  EXPECT_THAT(kmz.waylines_wpml, HasSubstr("<wpml:payloadEnumValue>50<"));
  EXPECT_THAT(kmz.template_kml, HasSubstr("<wpml:payloadEnumValue>50<"));
}

TEST(PhotoWpml, RejectsWhatAircraftIgnore) {
  const FlightPlan plan = with_photo_runs(photo_row_plan(mavic_3e()));
  const KmzContent kmz = unpack_kmz(write_kmz(plan));
  EXPECT_THAT(kmz.waylines_wpml, HasSubstr("<wpml:actionTriggerParam>3.000<"));
  const auto checked = [&](const std::string& from, const std::string& to) {
    return validate_kmz(
        pack_kmz({replaced(kmz.template_kml, from, to), replaced(kmz.waylines_wpml, from, to)}));
  };
  EXPECT_THAT(checked("Index>visable<", "Index>visible<"), Contains(HasSubstr("\"visible\"")));
  EXPECT_THAT(checked("<wpml:actionTriggerParam>3.000<", "<wpml:actionTriggerParam>0<"),
              Contains(HasSubstr("actionTriggerParam")));
  EXPECT_THAT(validate_kmz(pack_kmz(
                  {kmz.template_kml, replaced(kmz.waylines_wpml, "Param>3.000<", "Param>2.000<")})),
              Contains(HasSubstr("differ")));
  EXPECT_THAT(interpret({replaced(kmz.template_kml, "multipleDistance", "multipleTiming"),
                         replaced(kmz.waylines_wpml, "multipleDistance", "multipleTiming")},
                        make_flight_facts(plan))
                  .problems,
              Contains(HasSubstr("multipleTiming; it must be reachPoint or multipleDistance")));
}

TEST(PhotoRuns, OfAFileAreThoseOfTheMission) {
  const FlightPlan plan = with_photo_runs(photo_row_plan(vehicle_profile("generic")));
  MavlinkMission file = read_plan(write_plan(plan));
  const auto trigger = std::ranges::find_if(file.items, [](const MissionItem& item) {
    return item.command == command::camera_trigger_distance && item.params[0] > 0.0;
  });
  ASSERT_NE(trigger, file.items.end());
  const auto problems = [&] { return interpret(file, make_flight_facts(plan)).problems; };
  EXPECT_THAT(problems(), IsEmpty());
  trigger->params[0] = 2.0;
  EXPECT_THAT(problems(), Contains(HasSubstr("at a position that is not a view of the mission")));
  trigger->params[0] = 0.01;
  EXPECT_THAT(problems(), Contains(HasSubstr("at least 0.1 m")));
  trigger->params[0] = 3.0;
  trigger->params[2] = 1.0;
  EXPECT_THAT(problems(), Contains(HasSubstr("captures an image immediately")));
}

TEST(LitchiParts, HoldTheWholeFlightInFilesOf99Waypoints) {
  FlightPlan plan = photo_row_plan(vehicle_profile("generic"));
  const Waypoint end = plan.waypoints.back();
  std::size_t capture_point = 1;
  while (!plan.waypoints[capture_point].is_capture_point) ++capture_point;
  const Waypoint photo = plan.waypoints[capture_point];
  plan.waypoints.resize(1);
  for (int i = 0; i < 230; ++i) {
    plan.waypoints.push_back(photo);
    plan.waypoints.back().position.x() += 0.2 * i;
  }
  plan.waypoints.push_back(end);
  const std::vector<FlightPlan> parts = split_plan(plan, Format::litchi);
  ASSERT_EQ(parts.size(), 3U);
  std::size_t photos = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_LE(parts[i].waypoints.size(), 99U);
    EXPECT_THAT(validate_litchi(write_litchi(parts[i])), IsEmpty());
    if (i > 0) {
      EXPECT_EQ(parts[i].waypoints.front().position, parts[i - 1].waypoints.back().position);
      EXPECT_EQ(parts[i].waypoints.front().captures, 0);
    }
    for (const Waypoint& waypoint : parts[i].waypoints) photos += waypoint.captures;
  }
  EXPECT_EQ(photos, 230U);
  EXPECT_EQ(parts.back().waypoints.back().position, end.position);
}

}  // namespace
}  // namespace skycap::flight
