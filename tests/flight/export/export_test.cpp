// Common rules of all formats: files are valid, read back as the same flight, and are verified
// again before they get their final name.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/trajectory_file.h"
#include "flight/export/wpml_file.h"
#include "flight/interpreter/interpret.h"
#include "flight/interpreter/verified_export.h"
#include "geometry/error.h"
#include "tests/flight/export/sample_plan.h"
#include "tests/support/complaint.h"
#include "tests/support/not_empty.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::IsEmpty;

Vehicle vehicle_for(Format format) {
  return vehicle_profile(format == Format::kmz ? "m350_rtk" : "generic");
}

std::string read_content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Temporary directory that is removed at the end of the test.
class Scratch {
 public:
  Scratch() : path_(std::filesystem::temp_directory_path() / "skycap_export_XXXXXX") {
    std::string name = path_.string();
    path_ = mkdtemp(name.data());
  }
  ~Scratch() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  bool has(const std::string& name) const { return std::filesystem::exists(path_ / name); }

 private:
  std::filesystem::path path_;
};

const FormatInfo& find_info(Format format) { return formats()[static_cast<std::size_t>(format)]; }

class EveryFormat : public testing::TestWithParam<Format> {};

// Positions equal those of the plan to half a unit of the last written digit and of 1e-7 degrees.
TEST_P(EveryFormat, RoundTripsTheFlightPlan) {
  const Format format = GetParam();
  const FlightPlan plan = sample_plan(vehicle_for(format));
  const std::string content = write(plan, format);
  EXPECT_THAT(validate(content, format), IsEmpty());
  EXPECT_EQ(write(plan, format), content) << "not the same bytes each time";
  const InterpretedRoute route = interpret(content, format, make_flight_facts(plan));
  EXPECT_THAT(route.problems, IsEmpty());
  std::vector<Vector3d> executed_points;
  for (const InterpretedSegment& segment : route.segments) {
    if (segment.is_over_pad) continue;
    executed_points.push_back(segment.start.to);
    executed_points.push_back(segment.to);
  }
  for (const Waypoint& waypoint : plan.waypoints) {
    double nearest = 1e9;
    for (const Vector3d& point : executed_points)
      nearest = std::min(nearest, (point - waypoint.position).norm());
    EXPECT_LT(nearest, rounding_bound);
  }
  // Each point that is read is on a leg of the plan.
  for (const Vector3d& point : executed_points) {
    double nearest_leg = 1e9;
    for (std::size_t i = 1; i < plan.waypoints.size(); ++i) {
      const Segment leg{plan.waypoints[i - 1].position, plan.waypoints[i].position};
      nearest_leg = std::min(nearest_leg, std::sqrt(nearest(leg, point).squared_distance));
    }
    EXPECT_LT(nearest_leg, rounding_bound);
  }
}

TEST_P(EveryFormat, WritesFileOnlyAfterVerification) {
  const Format format = GetParam();
  const FlightPlan plan = sample_plan(vehicle_for(format));
  const Scratch scratch;
  const std::string name = std::string("mission") + find_info(format).extension;
  const KnownSpace space(sample_site());
  const ExportResult result = export_flight(plan, format, space, scratch / name);
  EXPECT_GE(result.min_clearance, plan.clearance - rounding_bound);
  EXPECT_EQ(read_content(scratch / name), write(plan, format));

  // An obstacle is added after planning. The file must not change.
  Obstacles changed = sample_site();
  changed.cloud = {
      {(0.5 * (plan.waypoints[1].position + plan.waypoints[2].position)).cast<float>()}, 0.1};
  FlightPlan renamed = plan;
  renamed.name = "another";
  EXPECT_THAT(testing_support::thrown_message(
                  [&] { export_flight(renamed, format, KnownSpace(changed), scratch / name); }),
              testing::HasSubstr(" was not written: "));
  EXPECT_EQ(read_content(scratch / name), write(plan, format));
  EXPECT_FALSE(scratch.has(name + ".part"));

  const auto points = read_route(scratch / name, plan.site, plan.pad);
  EXPECT_THAT(check_route(points, space, plan.clearance - rounding_bound), IsEmpty());
}

// The interpreter reads every capture of a format that commands the camera, with its direction.
TEST_P(EveryFormat, InterpretsCapturesIfFormatCommandsCamera) {
  const Format format = GetParam();
  const FlightPlan plan = sample_plan(vehicle_for(format));
  int planned = 0, written = 0;
  for (const Waypoint& waypoint : plan.waypoints) planned += waypoint.captures;
  ASSERT_GT(planned, 0);
  const InterpretedRoute route = interpret(write(plan, format), format, make_flight_facts(plan));
  for (const InterpretedStop& stop : route.stops) {
    EXPECT_TRUE(std::isfinite(stop.yaw_deg)) << stop.item;
    written += stop.captures;
  }
  EXPECT_EQ(written, captures_images(format) ? planned : 0)
      << "add the format to flight/interpreter/interpret.cpp";
}

// Tests run in the source folder.
TEST_P(EveryFormat, IsListedInTheReference) {
  const std::string page = read_content("docs/reference/route-formats.md");
  if (page.empty()) GTEST_SKIP() << "not run in the source folder";
  const FormatInfo& info = find_info(GetParam());
  EXPECT_THAT(page, testing::AnyOf(HasSubstr("| `mission" + std::string(info.extension) + "`"),
                                   HasSubstr("| `export --format " + std::string(info.name) + "`")))
      << "add the format to the table in docs/reference/route-formats.md";
}

std::vector<Format> all_formats() {
  std::vector<Format> all;
  for (const FormatInfo& info : formats()) all.push_back(info.format);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Export, EveryFormat, testing::ValuesIn(all_formats()),
                         [](const auto& parameter) {
                           std::string name = find_info(parameter.param).name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// Curves in files are verified again between their written points. A mission without a name key has
// the name of its file, which may contain any bytes.
TEST(Export, AcceptsPlanNameThatIsNotUtf8) {
  for (const Format format : {Format::plan, Format::geojson}) {
    FlightPlan plan = sample_plan(vehicle_for(format));
    plan.name = "caf\xE9";
    EXPECT_THAT(validate(write(plan, format), format), IsEmpty());
  }
}

TEST(Export, WritesVerifiedCurvesInCurveFormats) {
  const FlightPlan stops = corner_plan(FlightStyle::stop);
  for (const FlightStyle style : {FlightStyle::blend, FlightStyle::smooth, FlightStyle::pass}) {
    const FlightPlan plan = corner_plan(style);
    EXPECT_LT(plan.waypoints.size(), stops.waypoints.size());
    EXPECT_LT(stop_times(plan).back().departure, stop_times(stops).back().departure - 1.0);
    const Scratch scratch;
    const KnownSpace space(sample_site());
    for (const FormatInfo& info : testing_support::not_empty(formats())) {
      if (!supports_curves(info.format)) continue;
      const std::string name = std::string("mission") + info.extension;
      EXPECT_GE(export_flight(plan, info.format, space, scratch / name).min_clearance,
                plan.clearance - rounding_bound);
      const auto points = read_route(scratch / name, plan.site, plan.pad);
      EXPECT_GT(points.size(), 3 * plan.waypoints.size()) << info.name << " holds no curve";
    }
  }
}

TEST(Export, RejectsAmslFormatsWithoutGeoidUndulation) {
  for (const FormatInfo& info : testing_support::not_empty(formats())) {
    FlightPlan plan = sample_plan(vehicle_for(info.format));
    plan.site.geoid_undulation.reset();
    const bool needs_it = std::string(info.heights).find("mean sea level") != std::string::npos;
    try {
      write(plan, info.format);
      EXPECT_FALSE(needs_it) << info.name;
    } catch (const Error& error) {
      EXPECT_TRUE(needs_it) << info.name;
      EXPECT_THAT(error.what(), HasSubstr("geoid undulation"));
    }
  }
}

TEST(Export, NotesElementsThatFormatCannotContain) {
  const Scratch scratch;
  const KnownSpace space(sample_site());
  const ExportResult plan = export_flight(sample_plan(vehicle_profile("generic")), Format::plan,
                                          space, scratch / "mission.plan");
  EXPECT_THAT(plan.notes, testing::ElementsAre(HasSubstr("\"shed\" is omitted")));
}

TEST(Export, RejectsUnknownFormatsAndFiles) {
  EXPECT_EQ(format_named("kmz"), Format::kmz);
  EXPECT_THAT(testing_support::thrown_message([&] { format_named("dwg"); }),
              testing::HasSubstr("unknown format \"dwg\""));
  EXPECT_THAT(testing_support::thrown_message(
                  [&] { read_route("/nowhere/mission.plan", {}, Vector3d::Zero()); }),
              testing::HasSubstr("/nowhere/mission.plan: "));
  EXPECT_THAT(testing_support::thrown_message([&] { detect_format("a.dwg", ""); }),
              testing::HasSubstr("a.dwg is not a route file"));
  EXPECT_EQ(detect_format("a.csv", "latitude,longitude"), Format::litchi);
  EXPECT_EQ(detect_format("a.csv", "# frame: NED"), Format::csv);
}

// xmllint, if installed, is an independent reader of the XML formats.
TEST(Export, WritesXmlThatXmllintAccepts) {
  if (std::system("command -v xmllint > /dev/null 2>&1") != 0) GTEST_SKIP() << "no xmllint";
  const Scratch scratch;
  const KmzContent kmz = unpack_kmz(write(sample_plan(vehicle_profile("m30t")), Format::kmz));
  const std::string kml = write(sample_plan(vehicle_profile("generic")), Format::kml);
  for (const std::string& content : {kmz.template_kml, kmz.waylines_wpml, kml}) {
    const std::filesystem::path path = scratch / "file.xml";
    std::ofstream(path, std::ios::binary) << content;
    EXPECT_EQ(std::system(("xmllint --noout " + path.string()).c_str()), 0);
  }
}

// ---- trajectories ----------------------------------------------------------------------------

// Numerical derivatives equal the stated velocities and accelerations.
class TrajectoryStyles : public testing::TestWithParam<FlightStyle> {};

TEST_P(TrajectoryStyles, HaveVelocitiesAndAccelerationsThatMatchDerivatives) {
  const FlightPlan plan = corner_plan(GetParam());
  constexpr double dt = 0.001;
  const std::vector<TimedState> states = trajectory(plan, dt);
  ASSERT_GT(states.size(), 2U);
  for (std::size_t i = 1; i + 1 < states.size(); ++i) {
    const TimedState &before = states[i - 1], &now = states[i], &after = states[i + 1];
    const double span = after.time - before.time;
    // Jerk is limited to 4 m/s^3. The error of the differences is smaller than the jerk times the
    // step.
    EXPECT_LT(((after.position - before.position) / span - now.velocity).norm(), 8e-3);
    EXPECT_LT(((after.velocity - before.velocity) / span - now.acceleration).norm(), 2e-2);
    EXPECT_LE(now.velocity.norm(), plan.conditions.cruise_speed + 1e-9);
    EXPECT_LE(now.acceleration.head<2>().norm(), plan.vehicle.mode.acceleration + 1e-9);
    EXPECT_LE(std::abs(now.acceleration.z()), plan.vehicle.mode.vertical_acceleration + 1e-9);
  }
  EXPECT_NEAR(states.back().time, stop_times(plan).back().departure, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Styles, TrajectoryStyles,
                         testing::Values(FlightStyle::stop, FlightStyle::blend, FlightStyle::smooth,
                                         FlightStyle::pass));

// Fly-through capture takes each view's image at the same position and in the same direction as
// stop-and-capture. The vehicle moves meanwhile, within the speed limit.
TEST(Trajectory, CapturesSameViewsInFlyThroughAsAtStops) {
  const auto captures = [](FlightStyle style) {
    std::vector<TimedState> captured;
    for (const TimedState& state : trajectory(corner_plan(style), 0.1)) {
      if (state.is_capture) captured.push_back(state);
    }
    return captured;
  };
  const std::vector<TimedState> stopped = captures(FlightStyle::stop),
                                passed = captures(FlightStyle::pass);
  ASSERT_EQ(stopped.size(), 3U);
  ASSERT_EQ(passed.size(), stopped.size());
  std::size_t moving = 0;
  for (std::size_t i = 0; i < passed.size(); ++i) {
    EXPECT_LT((passed[i].position - stopped[i].position).norm(), 1e-5);
    EXPECT_NEAR(std::remainder(passed[i].yaw - stopped[i].yaw, 2 * M_PI), 0.0, 1e-9);
    EXPECT_NEAR(passed[i].pitch, stopped[i].pitch, 1e-9);
    EXPECT_EQ(passed[i].yaw_rate, 0.0);
    EXPECT_LE(passed[i].velocity.norm(), 3.0 + 1e-6);
    moving += passed[i].velocity.norm() > 0.1 ? 1 : 0;
  }
  EXPECT_GE(moving, 2U);
}

TEST(Trajectory, RoundTripsThroughCsvInBothFrames) {
  const std::vector<TimedState> states = trajectory(sample_plan(vehicle_profile("generic")), 0.5);
  for (const Frame frame : {Frame::enu, Frame::ned}) {
    const std::vector<TimedState> read = read_trajectory_csv(write_trajectory_csv(states, frame));
    ASSERT_EQ(read.size(), states.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_LT((read[i].position - states[i].position).norm(), 1e-5);
      EXPECT_LT((read[i].velocity - states[i].velocity).norm(), 1e-5);
      EXPECT_NEAR(std::remainder(read[i].yaw - states[i].yaw, 2 * M_PI), 0.0, 1e-5);
      EXPECT_EQ(read[i].is_capture, states[i].is_capture);
    }
  }
}

TEST(Trajectory, WritesNedPositionsAndYawFromNorth) {
  TimedState state{1.0, {10, 20, 30}, {1, 2, 3}, {0, 0, 0}, 0.5, 0.1, -0.2, true};
  EXPECT_THAT(write_trajectory_csv({state}, Frame::ned),
              HasSubstr("1.000000,20.000000,10.000000,-30.000000,2.000000,1.000000,-3.000000,"));
  EXPECT_THAT(write_trajectory_csv({state}, Frame::ned),
              HasSubstr(",0.500000,0.100000,-0.200000,1"));
  EXPECT_THAT(write_trajectory_csv({state}, Frame::enu),
              HasSubstr(",1.070796,-0.100000,-0.200000,1"));
}

TEST(Trajectory, RoundTripsThroughTumWithWLast) {
  const auto poses = camera_poses(trajectory(sample_plan(vehicle_profile("generic")), 0.5));
  const auto read = read_tum(write_tum(poses));
  ASSERT_EQ(read.size(), poses.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_TRUE(read[i].world_from_camera.isApprox(poses[i].world_from_camera, 1e-7));
  }
  TimedPose still;
  EXPECT_THAT(write_tum({still}), HasSubstr(" 0.000000000 0.000000000 0.000000000 1.000000000\n"));
}

TEST(Trajectory, RejectsInvalidFilesWithLineNumber) {
  EXPECT_THAT(validate_tum("0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n"),
              testing::Contains(HasSubstr("line 2 has a time that is not later")));
  EXPECT_THAT(validate_tum("0 0 0 0 0 0 0 2\n"), testing::Contains(HasSubstr("length 2")));
  EXPECT_THAT(validate_tum("0 0 0 0 0 0 1\n"), testing::Contains(HasSubstr("7 numbers")));
  EXPECT_THAT(validate_tum("0 0 x 0 0 0 0 1\n"), testing::Contains(HasSubstr("\"x\"")));
  EXPECT_THAT(validate_tum("# only a comment\n"), testing::Contains(HasSubstr("no row")));
  EXPECT_THAT(validate_trajectory_csv("t,x\n0,0\n"), testing::Contains(HasSubstr("frame")));
  EXPECT_THAT(testing_support::thrown_message(
                  [&] { trajectory(sample_plan(vehicle_profile("generic")), 0.0); }),
              testing::HasSubstr("interval is 0.0"));
}

// ---- geodesy ---------------------------------------------------------------------------------

// At the equator and at the pole, the radii of the ellipsoid have closed forms.
TEST(Geodesy, MatchesClosedFormsOnEquatorAndPole) {
  constexpr double a = 6378137.0, f = 1.0 / 298.257223563;
  const LocalFrame equator({0, 0, 0});
  const double angle = 0.01 * M_PI / 180.0;
  const Vector3d east = equator.to_local({0, 0.01, 0});
  EXPECT_NEAR(east.x(), a * std::sin(angle), 1e-6);
  EXPECT_NEAR(east.z(), a * (std::cos(angle) - 1.0), 1e-6);
  const LocalFrame pole({90, 0, 0});
  EXPECT_NEAR(pole.to_local({90, 0, 100}).z(), 100.0, 1e-6);
  EXPECT_NEAR(pole.to_local({-90, 0, 0}).z(), -2 * a * (1 - f), 1e-6);
}

TEST(Geodesy, RoundTripsBetweenLocalAndGeodetic) {
  for (double latitude = -85; latitude <= 85; latitude += 17) {
    for (double longitude = -179; longitude <= 179; longitude += 53) {
      const LocalFrame frame({latitude, longitude, 250});
      const Vector3d local(523.4, -811.2, 77.7);
      EXPECT_LT((frame.to_local(frame.to_geodetic(local)) - local).norm(), 1e-6);
    }
  }
}

TEST(Geodesy, RejectsInvalidSites) {
  EXPECT_THAT(testing_support::thrown_message([&] {
                Site{{91, 0, 0}, {}}.validate();
              }),
              testing::HasSubstr("latitude is 91.0"));
  EXPECT_THAT(testing_support::thrown_message([&] {
                Site{{0, 181, 0}, {}}.validate();
              }),
              testing::HasSubstr("longitude is 181.0"));
  EXPECT_THAT(testing_support::thrown_message([&] {
                Site{{0, 0, std::nan("")}, {}}.validate();
              }),
              testing::HasSubstr("ellipsoid height is nan"));
  EXPECT_THAT(testing_support::thrown_message([&] {
                Site{{0, 0, 0}, 500.0}.validate();
              }),
              testing::HasSubstr("geoid undulation is 500.0"));
}

}  // namespace
}  // namespace skycap::flight
