// Pads and return altitudes for a mission around a plain building.
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/geodesy.h"
#include "geometry/angle.h"
#include "geometry/pose/camera.h"
#include "missions/config/resolve.h"
#include "missions/package/package.h"
#include "missions/session/survey_flight.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using geometry::radians_per_degree;
using testing::HasSubstr;
using tests::run_skycap;
using tests::TestFolder;

constexpr double building_height = 15.0;
const Vector3d pad(-75, 0, 0);

/// Returns a closed box as OBJ text. The slope of its top [m/m] rises to the east.
std::string box_obj(const Vector3d& low, const Vector3d& high, double slope, int first) {
  std::string text;
  for (int corner = 0; corner < 8; ++corner) {
    Vector3d position(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                      corner & 4 ? high.z() : low.z());
    if (corner & 4) position.z() += slope * (position.x() - 0.5 * (low.x() + high.x()));
    text += "v " + std::to_string(position.x()) + " " + std::to_string(position.y()) + " " +
            std::to_string(position.z()) + "\n";
  }
  const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& face : faces) {
    text += "f";
    for (const int corner : face) text += " " + std::to_string(first + corner);
    text += "\n";
  }
  return text;
}

std::string building() { return box_obj({-10, -10, 0}, {10, 10, building_height}, 0.0, 1); }

/// Returns the building and a slab of 2 m below the pad, with this slope. A second slab on the
/// other side keeps the centre of the scene. The lowest point is 1 m below the pad.
std::string building_with_slab(double slope_deg) {
  const double slope = std::tan(slope_deg * radians_per_degree);
  return building() + box_obj({-76, -1, -1}, {-74, 1, 0}, slope, 9) +
         box_obj({74, -1, -1}, {76, 1, 0}, 0.0, 17);
}

std::string mission_round(const std::string& model) {
  return tests::flight_mission_around("{model: '" + model + "', ground: true}", "-14, -14",
                                      "14, 14, 18");
}

/// Returns the package of one survey. The tests only read it.
const TestFolder& package() {
  static const TestFolder folder;
  static const bool is_made = [] {
    folder.write("building.obj", building());
    folder.write("steep.obj", building_with_slab(14.0));
    folder.write("gentle.obj", building_with_slab(6.0));
    const std::string mission = folder.write("m.yaml", mission_round("building.obj"));
    const auto run = run_skycap({"plan", mission, "--out", folder / "out"});
    EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
    return true;
  }();
  EXPECT_TRUE(is_made);
  return folder;
}

/// Returns a PX4 route from the pad through `positions` and back on the same path, with a stop at
/// each position.
std::string route_there_and_back(const std::vector<Vector3d>& positions) {
  const flight::LocalFrame frame({47.1, 8.2, 480.0});
  std::string text = "QGC WPL 110\n";
  int items = 0;
  const auto add = [&](int command, double hold, const Vector3d& position) {
    const flight::GeodeticPoint point = frame.to_geodetic(position);
    std::array<char, 160> line{};
    std::snprintf(line.data(), line.size(), "%d\t%d\t3\t%d\t%.1f\t0.3\t0\t0\t%.9f\t%.9f\t%.4f\t1\n",
                  items, items == 0 ? 1 : 0, command, hold, point.latitude_deg, point.longitude_deg,
                  position.z());
    text += line.data();
    ++items;
  };
  constexpr int waypoint = 16, land = 21, take_off = 22;
  const Vector3d above_pad = pad + Vector3d(0, 0, 5);
  add(take_off, 0.0, above_pad);
  text += "1\t0\t2\t178\t1\t4\t-1\t0\t0\t0\t5\t1\n";  // speed of 4 m/s
  ++items;
  for (const Vector3d& position : positions) add(waypoint, 0.5, position);
  for (auto position = positions.rbegin() + 1; position != positions.rend(); ++position) {
    add(waypoint, 0.5, *position);
  }
  add(waypoint, 0.5, above_pad);
  add(land, 0.0, pad);
  return text;
}

tests::ProgramRun check(const std::vector<std::string>& more,
                        const std::string& route = "out/mission.plan") {
  const TestFolder& folder = package();
  std::vector<std::string> arguments{"check", folder / "m.yaml", "--route", folder / route};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_skycap(arguments);
}

// The route leads around the building. A direct return at 5 m from behind it would cross it.
TEST(StatedReturns, AreRejectedAtAltitudeThroughBuilding) {
  package().write("behind.waypoints",
                  route_there_and_back({{-22, -22, 6}, {22, -22, 6}, {22, 0, 6}}));
  const auto check_return = [](const std::string& height) {
    return check({"--return-altitude", height}, "behind.waypoints");
  };
  const auto low = check_return("5");
  EXPECT_EQ(low.exit_code, 1);
  EXPECT_THAT(low.out, HasSubstr(": verified, 0 of "));  // the mission itself is verified
  EXPECT_THAT(low.out, HasSubstr("not verified: at 5 m (--return-altitude) "));
  EXPECT_THAT(low.out, HasSubstr(" of the scene"));
  const std::string min = "the lowest verified return altitude is ";
  ASSERT_THAT(low.out, HasSubstr(min));
  const double height = std::stod(low.out.substr(low.out.find(min) + min.size()));
  EXPECT_GE(height, building_height + 2.0 - 0.1);  // the clearance minus the verification slack
  EXPECT_EQ(check_return(std::to_string(height)).exit_code, 0);
}

TEST(Pads, AreRejectedBeforeSurveyWhenDeclaredTooSteep) {
  const TestFolder& folder = package();
  const auto run = run_skycap(
      {"plan", folder / "m.yaml", "--out", folder / "steep", "--set", "flight.pad_slope_deg=12"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err,
              HasSubstr("the landing point at (-75.00, 0.00, 0.00) has a slope of 12.0 degrees as "
                        "declared; the maximum is 10.0 degrees (flight.max_pad_slope_deg)"));
  EXPECT_FALSE(std::filesystem::exists(folder / "steep/summary.json"));

  const auto exported = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "export", folder / "out",   "--format", "csv",
        "--out",  folder / "again", "--set",    "flight.pad_slope_deg=12"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_skycap(arguments);
  };
  EXPECT_EQ(exported({}).exit_code, 2);
  const auto allowed = exported({"--set", "flight.max_pad_slope_deg=15"});
  EXPECT_EQ(allowed.exit_code, 0) << allowed.err;
  EXPECT_THAT(allowed.out, HasSubstr("  pad       slope 12.0 degrees as declared\n"));
}

TEST(Pads, AreRejectedWhenTerrainIsTooSteep) {
  const TestFolder folder;
  folder.write("building.obj", building());
  folder.write("slope.obj",
               "v -80 -5 -1.25\nv -70 -5 1.25\nv -70 5 1.25\nv -80 5 -1.25\nf 1 2 3\nf 1 3 4\n");
  const std::string mission =
      folder.write("m.yaml", mission_round("building.obj") +
                                 "prior: [{file: slope.obj, role: terrain, uncertainty: 0.1}]\n");
  const auto run = run_skycap({"check", mission});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  // A rise of 2.5 m over 10 m.
  EXPECT_THAT(run.out, HasSubstr("has a slope of 14.0 degrees in the terrain data")) << run.out;
}

TEST(Pads, AreCheckedAgainstSceneInRouteFiles) {
  const TestFolder& folder = package();
  const auto with = [&](const std::string& model) {
    return check(
        {"--set", "scene.model=" + (folder / model), "--set", "scene.position=[0, 0, -1]"});
  };
  const auto steep = with("steep.obj");
  EXPECT_EQ(steep.exit_code, 1);
  EXPECT_THAT(steep.out, HasSubstr(": verified, 0 of "));
  EXPECT_THAT(steep.out, HasSubstr("not verified: the landing point at (-75.00, 0.00, 0.00) has a "
                                   "slope of 14.0 degrees in the scene"));
  EXPECT_EQ(with("gentle.obj").exit_code, 0);
}

/// Returns the camera's scan of a ramp through the pad that rises to the east.
geometry::Scan make_ramp_scan(const geometry::Camera& camera, const geometry::View& view,
                              double slope) {
  geometry::Scan scan;
  scan.world_from_sensor = geometry::camera_pose(view);
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0.0, 0.02);
  const Vector3d normal = Vector3d(-slope, 0.0, 1.0).normalized();
  for (int row = 0; row < camera.height(); ++row) {
    for (int column = 0; column < camera.width(); ++column) {
      const Vector3d ray = scan.world_from_sensor.linear() * camera.ray({column, row}).normalized();
      const double range = normal.dot(pad - view.position) / normal.dot(ray);
      if (!(range > 0.0 && range < 50.0)) continue;
      scan.points.push_back((view.position + (range + noise(random)) * ray).cast<float>());
      scan.pixels.push_back(static_cast<std::uint32_t>(row * camera.width() + column));
    }
  }
  return scan;
}

TEST(Pads, AreRejectedWhenMeasuredTooSteep) {
  const TestFolder& folder = package();
  const config::MissionSetup mission = config::read_mission(folder / "m.yaml");
  const double slope = std::tan(13.0 * radians_per_degree);
  session::SurveyFlight flight(mission.flight(), geometry::look_at({-30, 0, 8}, {0, 0, 5}), 0);
  flight.add_scan(make_ramp_scan(geometry::Camera(mission.flight().capture.camera),
                                 geometry::look_at({-75, -8, 8}, {-75, 0, 0}), slope));
  const session::FlightRecord flight_record = flight.finish({});
  ASSERT_EQ(flight_record.landing_surfaces.size(), 1U);
  EXPECT_NEAR(flight_record.landing_surfaces[0].slope, 13.0 * radians_per_degree,
              0.5 * radians_per_degree);

  const package::PackagedSurvey survey = package::read_package(folder / "out", {});
  EXPECT_THAT(testing_support::thrown_message([&] {
                package::plan_flight(survey.flight, survey.measured, survey.pad, survey.views,
                                     survey.paths, flight_record.landing_surfaces);
              }),
              HasSubstr("degrees as measured; the maximum is 10.0 degrees"));
}

}  // namespace
}  // namespace skycap::missions
