// Photo mission from the mission file to the results. The target is prior data, and there is no
// scene model.
#include "missions/photo/photo_mission.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"
#include "missions/config/mission_document.h"
#include "missions/config/photo_camera_reader.h"
#include "missions/config/photo_rules.h"
#include "missions/config/resolve.h"
#include "missions/package/package.h"
#include "missions/photo/photo_results.h"
#include "missions/photo/surface_map.h"
#include "missions/report/photo_page.h"
#include "missions/wizard/takeoff_point.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* house_obj = R"(
v -4 -3 0
v 4 -3 0
v 4 3 0
v -4 3 0
v -4 -3 5
v 4 -3 5
v 4 3 5
v -4 3 5
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";

constexpr const char* mission_yaml = R"(
sensor: {photo_camera: mavic_3e_wide}
photo: {gsd: 0.0026, patterns: [dome]}
prior: [{file: house.obj, role: target, uncertainty: 0.1}]
limits: {stand_off: 3}
site: {latitude_deg: 51.75, longitude_deg: -1.25, geoid_undulation: 47}
flight: {vehicle: mavic_3e, free_space: assumed, position_error: 0.1, clearance: 2}
)";

class PhotoMissionTest : public testing::Test {
 protected:
  PhotoMissionTest() { write("house.obj", house_obj); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }
  config::MissionSetup read(const std::string& text,
                            const std::vector<config::KeyOverride>& overrides = {}) const {
    write("mission.yaml", text);
    return config::read_mission(folder_.path() / "mission.yaml", overrides);
  }
  std::string message(const std::string& text) const {
    try {
      read(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_config);
      return error.what();
    }
    return "";
  }
  static std::string without(std::string text, const std::string& part) {
    text.erase(text.find(part), part.size());
    return text;
  }
  static std::string with(std::string text, const std::string& part, const std::string& other) {
    text.replace(text.find(part), part.size(), other);
    return text;
  }

  testing_support::TemporaryFolder folder_;
};

TEST_F(PhotoMissionTest, IsResolvedWithoutAScene) {
  const config::MissionSetup setup = read(mission_yaml);
  const config::PhotoSetup photo = config::photo_setup(*setup.document);
  EXPECT_EQ(photo.options.rule.min_partners, 3);
  EXPECT_NEAR(setup.survey().planner.view_distance, 9.75, 0.01);
  EXPECT_EQ(photo.options.patterns.size(), 1U);
  const config::MissionSetup coarse =
      read(with(mission_yaml, "gsd: 0.0026", "gsd: 0.0026, pass: coarse"));
  const config::PhotoSetup first = config::photo_setup(*coarse.document);
  EXPECT_EQ(first.options.rule.min_partners, 4);
  EXPECT_DOUBLE_EQ(first.options.gsd, 0.0078);
}

TEST_F(PhotoMissionTest, RejectsKeysOfDepthSensingNamingTheirReplacement) {
  const std::string text = mission_yaml;
  EXPECT_THAT(message(text + "planner: {density: 100}\n"),
              HasSubstr("planner.density is for sensors that measure depth and conflicts with "
                        "sensor.photo_camera; set photo.gsd instead"));
  EXPECT_THAT(message(text + "planner: {name: see++}\n"), HasSubstr("set photo.pattern instead"));
  EXPECT_THAT(message(text + "start: {position: [1, 2, 3]}\n"), HasSubstr("remove it"));
}

TEST_F(PhotoMissionTest, RejectsAnUnknownTargetWithTheRemedy) {
  const std::string text =
      without(mission_yaml, "prior: [{file: house.obj, role: target, uncertainty: 0.1}]");
  EXPECT_THAT(message(text), HasSubstr("requires a target whose shape is known"));
  EXPECT_THAT(message(text), HasSubstr("photo.pass: coarse"));
}

TEST_F(PhotoMissionTest, RejectsKeysOfPhotosWithoutAPhotoCamera) {
  const std::string text = without(mission_yaml, "sensor: {photo_camera: mavic_3e_wide}");
  EXPECT_THAT(
      message(text + "scene: {model: builtin:teapot}\nevaluation: {coverage_distance: 1}\n"),
      HasSubstr("requires a photo camera; set sensor.photo_camera"));
}

TEST_F(PhotoMissionTest, RejectsWrongValues) {
  EXPECT_THAT(message(without(mission_yaml, "gsd: 0.0026, ")),
              HasSubstr("photo.gsd is missing; set the ground sampling distance"));
  EXPECT_THAT(message(with(mission_yaml, "[dome]", "[spiral]")),
              HasSubstr("unknown pattern spiral; expected one of: nadir, oblique, dome, facade"));
  EXPECT_THAT(message(with(mission_yaml, "gsd: 0.0026", "gsd: 0.0026, min_parallax_deg: 45")),
              HasSubstr("must be less than photo.max_parallax_deg"));
  EXPECT_THAT(message(with(mission_yaml, "mavic_3e_wide", "mavic_9")),
              HasSubstr("unknown photo camera mavic_9; expected one of: air_3_wide"));
}

TEST(PhotoCameraPresets, AreReadWithTheirGroundSamplingDistance) {
  for (const std::string_view name : config::photo_camera_presets()) {
    const geometry::PhotoCamera camera(config::find_photo_camera(std::string(name)));
    EXPECT_GT(camera.gsd(10.0), 0.8e-3) << name;
    EXPECT_LT(camera.gsd(10.0), 3.6e-3) << name;
  }
  EXPECT_NEAR(geometry::PhotoCamera(config::find_photo_camera("mavic_3e_wide")).gsd(10.0), 2.67e-3,
              0.01e-3);
}

TEST_F(PhotoMissionTest, MakesAVerifiedFlightWithItsFiles) {
  const config::MissionSetup setup = read(mission_yaml);
  const photo::PhotoAirspace airspace(setup, 2);
  photo::PhotoMission mission =
      photo::plan_photo_mission(setup, airspace, {}, [](const std::string&) {});
  ASSERT_TRUE(mission.flight);
  const flight::Route& route = mission.flight->route;
  EXPECT_EQ(route.capture_points.size(), mission.plan.photos.size());
  EXPECT_EQ(mission.plan.photos.size(), mission.result.views.size());
  EXPECT_TRUE(route.unreached.empty());
  EXPECT_GE(route.min_clearance, setup.flight().budget().total());
  // DJI vehicles climb before they return only farther than 50 m from the pad.
  for (const flight::CapturePoint& point : route.capture_points) {
    EXPECT_GT((point.view.position - mission.pad).head<2>().norm(), 54.0);
  }
  EXPECT_GE(mission.result.figures.attainable_share(mission.result.figures.satisfied), 0.95);
  ASSERT_FALSE(mission.warnings.empty());
  EXPECT_THAT(mission.warnings.front(),
              StartsWith("the airspace around the model is assumed free"));
  double last = 0.0;
  for (const survey::photo::PlannedPhoto& photo : mission.plan.photos) {
    EXPECT_GT(photo.time, last);
    last = photo.sortie == 0 ? photo.time : 0.0;
    EXPECT_GT(photo.gsd, 0.0);
  }

  // One point in front of the southern wall, and one under the floor.
  write("points.csv", "name,x,y,z\nA,0,-3.5,0.1\nB,0,0,-0.5\n");
  photo::add_control_points(setup, airspace, folder_.path() / "points.csv", mission);
  ASSERT_EQ(mission.control_points.size(), 2U);
  EXPECT_THAT(mission.warnings.back(), HasSubstr("control point \"B\" is visible in 0 photos"));

  const std::filesystem::path out = folder_.path() / "out";
  {
    geometry::OutputFolder folder(out);
    photo::stage_photo_mission(setup, airspace, mission, folder);
    folder.commit();
  }
  for (const char* name : {"mission.kmz", "mission.kml", "mission.csv", "photos.csv",
                           "photo_surface.csv", "control_points.csv", "field_sheet.html"}) {
    EXPECT_TRUE(std::filesystem::exists(out / name)) << name;
  }
  std::ifstream file(out / "summary.json");
  const auto summary = nlohmann::ordered_json::parse(file);
  EXPECT_EQ(summary["photo"]["photos"], mission.plan.photos.size());
  EXPECT_EQ(summary["photo"]["curve"].size(), mission.result.views.size());
  EXPECT_EQ(summary["photo"]["patterns"][0]["pattern"], "dome");
  const auto& curve = summary["photo"]["time_curve"];
  ASSERT_EQ(curve.size(), std::min<std::size_t>(12, mission.result.views.size()));
  EXPECT_EQ(curve.back()["photos"], mission.result.views.size());
  EXPECT_GT(curve.back()["tour_s"], curve.front()["tour_s"]);
  for (std::size_t i = 1; i < curve.size(); ++i) {
    EXPECT_GE(curve[i]["expected_completeness"], curve[i - 1]["expected_completeness"]);
  }
  const std::string sheet = geometry::read_file(out / "field_sheet.html");
  EXPECT_THAT(sheet, HasSubstr("Focus at 9.8 m"));
  EXPECT_THAT(sheet, HasSubstr("<li>A, "));
  EXPECT_THAT(sheet, HasSubstr("<li>B, 0 photos</li>"));
  EXPECT_THAT(sheet, HasSubstr("the airspace around the model is assumed free"));

  // The map has the same classes as the figures of the plan, at other samples.
  const std::vector<photo::SurfaceSample> map =
      photo::evaluate_surface(setup, airspace, mission.plan);
  ASSERT_GT(map.size(), 4000U);
  const auto good =
      std::ranges::count(map, photo::SurfaceClass::good, &photo::SurfaceSample::quality);
  const double all = static_cast<double>(map.size());
  EXPECT_NEAR(static_cast<double>(good) / all,
              mission.result.figures.share(mission.result.figures.good), 0.02);
  for (const photo::SurfaceSample& sample : map) {
    EXPECT_EQ(sample.observations == 0, sample.partners == -2);
    if (sample.observations == 0) continue;
    EXPECT_GE(sample.gsd, 0.3 * mission.plan.gsd);  // stand-off: 3 m of 9.75 m
  }

  const std::string page = report::photo_page(report::results_in(out), 100'000);
  EXPECT_THAT(page, HasSubstr("\"kind\":\"photos\""));
  EXPECT_THAT(page, HasSubstr("\"observations\""));
  write("out/photo_surface.csv",
        "x,y,z,class,partners,observations,gsd_m,parallax_deg,incidence_deg\n"
        "1,2,3,bad,0,0,,,\n");
  EXPECT_THROW(report::photo_page(report::results_in(out), 100), Error);

  // The package is read in the same way as by skycap export.
  const package::PackagedSurvey packaged = package::read_package(out, {});
  EXPECT_EQ(packaged.views.size(), mission.result.views.size());
  const flight::Route again = package::plan_flight(packaged.flight, packaged.measured, packaged.pad,
                                                   packaged.views, packaged.paths);
  EXPECT_EQ(again.capture_points.size(), route.capture_points.size());
  EXPECT_DOUBLE_EQ(again.length, route.length);
}

TEST_F(PhotoMissionTest, ChoosesATakeoffPointInsideTheGeofence) {
  const char* fence = "site: {geofence: [[-120, -40], [40, -40], [40, 40], [-120, 40]], ";
  const config::MissionSetup setup = read(with(mission_yaml, "site: {", fence));
  const std::vector<geometry::View> views{{{20, 0, 4}, {-1, 0, 0}}, {{-20, 0, 4}, {1, 0, 0}}};
  const Eigen::Vector3d pad = wizard::choose_takeoff(setup.flight(), views);
  EXPECT_LT(pad.x(), -74.0);
  EXPECT_GT(pad.x(), -120.0 + setup.flight().clearance);
  EXPECT_LT(std::abs(pad.y()), 40.0 - setup.flight().clearance);
  // The mission's own pad has priority.
  const config::MissionSetup own =
      read(with(mission_yaml, "clearance: 2}", "clearance: 2, takeoff: [30, 1, 0]}"));
  EXPECT_EQ(wizard::choose_takeoff(own.flight(), views), Eigen::Vector3d(30, 1, 0));
}

TEST_F(PhotoMissionTest, RejectsATargetOutsideTheGeofenceWithItsOffset) {
  const char* fence = "site: {geofence: [[80, 30], [120, 30], [120, 70], [80, 70]], ";
  const config::MissionSetup setup = read(with(mission_yaml, "site: {", fence));
  EXPECT_THAT([&] { photo::PhotoAirspace(setup, 1); },
              testing::ThrowsMessage<Error>(
                  HasSubstr("m in the mission frame, (-100.0, -50.0) m from the centre of the "
                            "geofence; set the keys crs and offset, or the key place")));
}

TEST_F(PhotoMissionTest, StaysOutsideOfTheUnknownBoxWhenSpaceIsMeasured) {
  const config::MissionSetup setup =
      read(with(with(mission_yaml, "free_space: assumed", "free_space: measured"),
                "gsd: 0.0026, patterns: [dome]", "gsd: 0.005, patterns: []"));
  const photo::PhotoAirspace airspace(setup, 2);
  const photo::PhotoMission mission =
      photo::plan_photo_mission(setup, airspace, {}, [](const std::string&) {});
  const Eigen::AlignedBox3d box = setup.flight().unknown_box;
  EXPECT_FALSE(box.isEmpty());
  for (const geometry::View& view : mission.result.views) {
    EXPECT_GE(box.exteriorDistance(view.position), setup.flight().clearance - 1e-6);
  }
}

}  // namespace
}  // namespace skycap::missions
