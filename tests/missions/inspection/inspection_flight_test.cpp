// Inspections as missions with waypoints: what an autopilot flies from the files.
#include "missions/inspection/inspection_flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "flight/export/export.h"
#include "flight/export/flight_plan.h"
#include "flight/export/wpml_file.h"
#include "flight/interpreter/interpret.h"
#include "geometry/angle.h"
#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"
#include "geometry/surfaces/mesh.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/config/mission_document.h"
#include "missions/config/preset_files.h"
#include "missions/config/resolve.h"
#include "missions/inspection/inspection_mission.h"
#include "missions/inspection/inspection_results.h"
#include "missions/package/package.h"
#include "tests/missions/inspection/block.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using survey::inspection::FlightSample;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* block_yaml = R"(
site: {latitude_deg: 51.7535, longitude_deg: -1.254, ellipsoid_height: 111.5, geoid_undulation: 46.7}
sensor: {photo_camera: mavic_3e_wide}
inspection: {range: 7, share: 0.9, spacing: 0.25, moves: 1500, searches: 1}
prior: [{file: block.obj, role: target, uncertainty: 0.1}]
flight: {free_space: assumed, position_error: 0.1, clearance: 2}
)";

geometry::Mesh block() {
  geometry::Mesh mesh;
  mesh.vertices = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0},
                   {-2, -2, 5}, {2, -2, 5}, {2, 2, 5}, {-2, 2, 5}};
  mesh.triangles = {{0, 3, 2}, {0, 2, 1}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                    {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  return mesh;
}

/// A planned and written inspection.
struct Written {
  inspection::InspectionMission mission;
  std::filesystem::path folder;
  nlohmann::json summary;
};

class InspectionFlightTest : public testing::TestWithParam<const char*> {
 protected:
  InspectionFlightTest() { std::ofstream(folder_.path() / "block.obj") << block_obj; }

  config::MissionSetup read(const std::string& vehicle,
                            const std::vector<config::KeyOverride>& more = {}) const {
    std::ofstream(folder_.path() / "mission.yaml") << block_yaml;
    std::vector<config::KeyOverride> overrides{{"--set", "flight.vehicle", vehicle}};
    overrides.insert(overrides.end(), more.begin(), more.end());
    return config::read_mission(folder_.path() / "mission.yaml", overrides);
  }

  Written write(const config::MissionSetup& setup) const {
    const inspection::InspectionSpace space(setup);
    Written written{plan_inspection_mission(setup, space, {}, [](const std::string&) {}),
                    folder_.path() / "results",
                    {}};
    geometry::OutputFolder folder(written.folder);
    stage_inspection_mission(setup, space, written.mission, folder);
    folder.commit();
    written.summary =
        nlohmann::json::parse(geometry::read_file(written.folder / package::summary_name));
    return written;
  }

  testing_support::TemporaryFolder folder_;
};

double distance_from(const Vector3d& point, const std::vector<FlightSample>& samples) {
  double nearest = 1e9;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const Vector3d from = samples[i - 1].position, chord = samples[i].position - from;
    const double squared = chord.squaredNorm();
    const double along =
        squared > 0.0 ? std::clamp((point - from).dot(chord) / squared, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (point - from - along * chord).norm());
  }
  return nearest;
}

/// Autopilot of this test. Flies the corners of a file with waypoints that are passed.
class TestAutopilot {
 public:
  TestAutopilot(const flight::InterpretedRoute& route, const flight::Vehicle& vehicle) {
    for (const flight::InterpretedSegment& segment : route.segments) {
      if (segment.is_over_pad) continue;
      if (corners_.empty()) corners_.push_back({segment.start.to, 0.0, 0.0});
      corners_.back().turn = segment.start.length();
      corners_.push_back({segment.to, 0.0, segment.speed});
    }
    vehicle.autopilot == flight::AutopilotType::ardupilot ? blend(vehicle.mode.acceleration)
                                                          : round();
  }

  /// Positions between the first and the last corner that is passed.
  const std::vector<Vector3d>& positions() const { return positions_; }

 private:
  struct Corner {
    Vector3d position;
    double turn = 0.0;   ///< 0: a stop [m].
    double speed = 0.0;  ///< On the leg that ends here [m/s].
  };

  /// Like ArduCopter: each leg is flown from rest to rest. After a corner that is passed, the next
  /// leg begins when the vehicle brakes on the leg before, behind its middle.
  void blend(double acceleration) {
    struct Leg {
      Vector3d from, direction;
      double length, speed, begin;
      double rise(double a) const { return speed / a; }
      double duration(double a) const { return length / speed + speed / a; }
      double progress(double t, double a) const {
        const double total = duration(a);
        if (t <= 0.0) return 0.0;
        if (t >= total) return length;
        if (t < rise(a)) return 0.5 * a * t * t;
        if (t > total - rise(a)) return length - 0.5 * a * (total - t) * (total - t);
        return 0.5 * speed * rise(a) + speed * (t - rise(a));
      }
    };
    std::vector<Leg> legs;
    for (std::size_t i = 1; i < corners_.size(); ++i) {
      const Vector3d chord = corners_[i].position - corners_[i - 1].position;
      const double length = chord.norm();
      if (length == 0.0) continue;
      Leg leg{corners_[i - 1].position, chord / length, length, corners_[i].speed, 0.0};
      if (!(leg.speed > 0.0)) leg.speed = 4.0;
      leg.speed = std::min(leg.speed, std::sqrt(length * acceleration));
      if (!legs.empty()) {
        const Leg& before = legs.back();
        const double end = before.duration(acceleration);
        const double overlap =
            corners_[i - 1].turn > 0.0
                ? std::min({before.rise(acceleration), leg.rise(acceleration), 0.5 * end})
                : 0.0;
        leg.begin = before.begin + end - overlap;
      }
      legs.push_back(leg);
    }
    const double end = legs.back().begin + legs.back().duration(acceleration);
    for (double t = 0.0; t < end; t += 0.02) {
      Vector3d position = corners_.front().position;
      for (const Leg& leg : legs) {
        position += leg.progress(t - leg.begin, acceleration) * leg.direction;
      }
      positions_.push_back(position);
    }
  }

  /// Parabolas that leave the legs at the turn distance before and after a corner.
  void round() {
    for (std::size_t i = 1; i + 1 < corners_.size(); ++i) {
      const Vector3d corner = corners_[i].position;
      const Vector3d in = corners_[i - 1].position - corner;
      const Vector3d out = corners_[i + 1].position - corner;
      const Vector3d from = corner + corners_[i].turn * in.normalized();
      const Vector3d to = corner + corners_[i].turn * out.normalized();
      for (double s = 0.0; s <= 1.0; s += 0.1) {
        positions_.push_back((1 - s) * (1 - s) * from + 2 * s * (1 - s) * corner + s * s * to);
      }
      positions_.push_back(0.5 * (to + corners_[i + 1].position));
    }
  }

  std::vector<Corner> corners_;
  std::vector<Vector3d> positions_;
};

std::string route_file(const std::string& vehicle) {
  if (vehicle == "mavic_3e") return "mission.kmz";
  return vehicle == "generic" ? "mission.plan" : "mission.waypoints";
}

TEST_P(InspectionFlightTest, FliesTheFilesWithinTheVerifiedDeviation) {
  const config::MissionSetup setup = read(GetParam());
  const Written written = write(setup);
  ASSERT_TRUE(written.mission.flight) << written.mission.flight_failure;
  const inspection::InspectionFlight& flight = *written.mission.flight;
  const flight::Route& route = flight.mission.route;
  EXPECT_THAT(route.unreached, IsEmpty());
  ASSERT_EQ(route.sorties.size(), 1U);
  EXPECT_LE(flight.deviation_bound, inspection::flown_deviation);

  const inspection::InspectionSpace space(setup);
  const flight::FlightPlan plan =
      flight_plan(route, 0, setup.name, setup.flight().site, space.flight().rules());
  const flight::InterpretedRoute interpreted = flight::interpret_file(
      written.folder / route_file(GetParam()), flight::make_flight_facts(plan));
  EXPECT_THAT(interpreted.problems, IsEmpty());

  const TestAutopilot autopilot(interpreted, route.vehicle);
  const geometry::MeshDistance distance(block());
  const Vector3d begin = written.mission.plan.samples.front().position,
                 end = written.mission.plan.samples.back().position;
  double largest = 0.0, nearest = 1e9;
  bool is_recorded = false;
  std::size_t compared = 0;
  for (const Vector3d& position : autopilot.positions()) {
    nearest = std::min(nearest, distance.distance(position));
    if ((position - begin).norm() < 0.05) is_recorded = true;
    if (is_recorded) {
      largest = std::max(largest, distance_from(position, written.mission.plan.samples));
      ++compared;
    }
    if (is_recorded && (position - end).norm() < 0.05 && compared > 20) break;
  }
  EXPECT_GT(compared, 100U);
  EXPECT_LE(largest, flight.deviation_bound + flight::rounding_bound);
  EXPECT_GT(largest, 0.01) << "the autopilot is not exact";
  EXPECT_GE(nearest, 2.1 - flight::rounding_bound);
  EXPECT_GE(written.summary.at("inspection").at("flown").at("verified_clearance_m").get<double>(),
            2.0 - flight::rounding_bound);
  // The aim steps from waypoint to waypoint, so that slightly fewer points are seen.
  EXPECT_GE(static_cast<double>(flight.seen[2]),
            0.95 * static_cast<double>(written.mission.plan.evaluation.seen[2]));
}

TEST_P(InspectionFlightTest, ResumesALongFlightWhereItWasCut) {
  // A vehicle whose missions have few items.
  std::string profile =
      config::preset_text("vehicle", GetParam(), config::vehicle_preset_files()).text;
  const std::size_t begin = profile.find("max_waypoints: ");
  const std::size_t end = profile.find_first_of(" \n", profile.find(' ', begin) + 1);
  profile.replace(begin, end - begin, "max_waypoints: 54");
  std::ofstream(folder_.path() / "small.yaml") << profile;
  const config::MissionSetup setup = read("small.yaml");
  const Written written = write(setup);
  ASSERT_TRUE(written.mission.flight) << written.mission.flight_failure;
  const flight::Route& route = written.mission.flight->mission.route;
  EXPECT_THAT(route.unreached, IsEmpty());
  ASSERT_GE(route.sorties.size(), 2U);
  for (std::size_t i = 0; i < route.sorties.size(); ++i) {
    const flight::FlightPlan plan = flight_plan(route, i, "block", setup.flight().site);
    EXPECT_GT(route.sorties[i].energy_left, 0.0);
    EXPECT_FALSE(recorded_stretch(plan).is_empty());
    if (i == 0) continue;
    EXPECT_EQ(route.sorties[i].first, route.sorties[i - 1].last) << "resumes where it was cut";
  }
  EXPECT_EQ(route.sorties.back().last + 1, route.capture_points.size());
  EXPECT_GE(static_cast<double>(written.mission.flight->seen[2]),
            0.95 * static_cast<double>(written.mission.plan.evaluation.seen[2]));
  const auto numbered = [&](const std::string& number) {
    std::string name = route_file(GetParam());
    return written.folder / name.insert(std::string("mission").size(), number);
  };
  EXPECT_TRUE(std::filesystem::exists(numbered("-1")));
  EXPECT_TRUE(std::filesystem::exists(numbered("-2")));
}

INSTANTIATE_TEST_SUITE_P(Vehicles, InspectionFlightTest,
                         testing::Values("mavic_3e", "generic", "generic_ardupilot"),
                         [](const auto& test) { return std::string(test.param); });

TEST_F(InspectionFlightTest, StatesWhyThereAreNoRouteFiles) {
  // Returns at the minimum altitude of DJI's apps are above the limit.
  const config::MissionSetup setup = read("mavic_3e", {{"--set", "site.max_height", "9"}});
  const Written written = write(setup);
  EXPECT_FALSE(written.mission.flight);
  EXPECT_THAT(written.mission.flight_failure, Not(IsEmpty()));
  EXPECT_EQ(written.summary.at("inspection").at("formats_not_written").at("kmz"),
            written.mission.flight_failure);
  EXPECT_FALSE(std::filesystem::exists(written.folder / "mission.kmz"));
  EXPECT_TRUE(std::filesystem::exists(written.folder / inspection::flight_name));
}

/// Elements of passed waypoints and their actions, with the values that DJI documents: page "Common
/// Elements" of the Cloud API (developer.dji.com, api-reference/dji-wpml/common-element; file
/// docs/en/60.api-reference/00.dji-wpml/40.common-element.md of dji-sdk/Cloud-API-Doc, and the
/// Chinese page that lists the Matrice 4 series). An empty list stands for numbers.
///
/// stopRecord has payloadLensIndex for the Matrice 30 only, and no useGlobalPayloadLensIndex.
struct DocumentedElement {
  const char* parent;
  const char* name;
  std::vector<std::string> values;
};

const std::vector<DocumentedElement>& documented_elements() {
  static const std::vector<std::string> positions{"0", "1", "2"};
  static const std::vector<DocumentedElement> elements{
      {"waypointTurnParam",
       "waypointTurnMode",
       {"coordinateTurn", "toPointAndStopWithDiscontinuityCurvature",
        "toPointAndStopWithContinuityCurvature", "toPointAndPassWithContinuityCurvature"}},
      {"waypointTurnParam", "waypointTurnDampingDist", {}},
      {"waypointHeadingParam",
       "waypointHeadingMode",
       {"followWayline", "manually", "fixed", "smoothTransition", "towardPOI"}},
      {"waypointHeadingParam", "waypointHeadingAngle", {}},
      {"waypointHeadingParam",
       "waypointHeadingPathMode",
       {"clockwise", "counterClockwise", "followBadArc"}},
      {"actionTrigger",
       "actionTriggerType",
       {"reachPoint", "betweenAdjacentPoints", "multipleTiming", "multipleDistance"}},
      {"gimbalEvenlyRotate", "gimbalPitchRotateAngle", {}},
      {"gimbalEvenlyRotate", "payloadPositionIndex", positions},
      {"startRecord", "payloadPositionIndex", positions},
      {"startRecord", "fileSuffix", {"inspection"}},
      {"startRecord", "payloadLensIndex", {"wide", "zoom", "ir", "narrow_band", "visable"}},
      {"startRecord", "useGlobalPayloadLensIndex", {"0", "1"}},
      {"stopRecord", "payloadPositionIndex", positions}};
  return elements;
}

/// Returns the name without namespace prefix; actuator parameters have the name of their action.
std::string local_name(const pugi::xml_node& node) {
  const std::string name = node.name();
  if (name == "wpml:actionActuatorFuncParam") {
    return node.parent().child("wpml:actionActuatorFunc").text().get();
  }
  return name.starts_with("wpml:") ? name.substr(5) : name;
}

// Sections waypointTurnParam, waypointHeadingParam, actionGroup and gimbalEvenlyRotate of the page
// above, and waypointSpeed of "Waylines.wpml".
TEST_F(InspectionFlightTest, WritesValuesInDocumentedRanges) {
  const Written written = write(read("mavic_3e"));
  const flight::KmzContent content =
      flight::unpack_kmz(geometry::read_file(written.folder / "mission.kmz"));
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(content.waylines_wpml.c_str()));
  const std::vector<Vector3d> positions = flight::read_positions(
      geometry::read_file(written.folder / "mission.kmz"), flight::Format::kmz,
      read("mavic_3e").flight().site, written.mission.flight->pad);
  std::vector<double> damping;
  int group = 0;
  for (const pugi::xpath_node& match : document.select_nodes("//Placemark")) {
    const pugi::xml_node mark = match.node();
    const pugi::xml_node turn = mark.child("wpml:waypointTurnParam");
    const bool is_passed =
        std::string(turn.child("wpml:waypointTurnMode").text().get()) == "coordinateTurn";
    damping.push_back(turn.child("wpml:waypointTurnDampingDist").text().as_double());
    if (is_passed) {
      EXPECT_GT(damping.back(), 0.0);
    }
    EXPECT_EQ(std::string(mark.child("wpml:useStraightLine").text().get()), "1");
    EXPECT_GT(mark.child("wpml:waypointSpeed").text().as_double(), 0.0);
    EXPECT_LE(mark.child("wpml:waypointSpeed").text().as_double(), 15.0);
    const pugi::xml_node heading = mark.child("wpml:waypointHeadingParam");
    EXPECT_EQ(std::string(heading.child("wpml:waypointHeadingMode").text().get()),
              "smoothTransition");
    EXPECT_LE(std::abs(heading.child("wpml:waypointHeadingAngle").text().as_double()), 180.0);
    for (const pugi::xml_node actions : mark.children("wpml:actionGroup")) {
      EXPECT_EQ(actions.child("wpml:actionGroupId").text().as_int(), group++);
      const int first = actions.child("wpml:actionGroupStartIndex").text().as_int();
      const int last = actions.child("wpml:actionGroupEndIndex").text().as_int();
      EXPECT_GE(last, first);
      const std::string trigger =
          actions.child("wpml:actionTrigger").child("wpml:actionTriggerType").text().get();
      const std::string function =
          actions.child("wpml:action").child("wpml:actionActuatorFunc").text().get();
      EXPECT_EQ(function == "gimbalEvenlyRotate", trigger == "betweenAdjacentPoints");
    }
  }
  // A leg is longer than the damping distances at its ends.
  ASSERT_EQ(damping.size(), positions.size());
  for (std::size_t i = 1; i < positions.size(); ++i) {
    EXPECT_LT(damping[i - 1] + damping[i], (positions[i] - positions[i - 1]).norm()) << i;
  }
}

TEST_F(InspectionFlightTest, WritesOnlyDocumentedElementsAndValues) {
  const Written written = write(read("mavic_3e"));
  const flight::KmzContent content =
      flight::unpack_kmz(geometry::read_file(written.folder / "mission.kmz"));
  for (const std::string& text : {content.template_kml, content.waylines_wpml}) {
    pugi::xml_document document;
    ASSERT_TRUE(document.load_string(text.c_str()));
    std::size_t turns = 0, pitches = 0, starts = 0, stops = 0;
    for (const pugi::xpath_node& match : document.select_nodes("//*[not(*)]")) {
      const std::string parent = local_name(match.node().parent());
      const std::string name = local_name(match.node()), value = match.node().text().get();
      turns += value == "coordinateTurn" ? 1 : 0;
      pitches += value == "gimbalEvenlyRotate" ? 1 : 0;
      starts += value == "startRecord" ? 1 : 0;
      stops += value == "stopRecord" ? 1 : 0;
      const auto& all = documented_elements();
      if (std::ranges::none_of(all, [&](const auto& one) { return parent == one.parent; })) {
        continue;
      }
      EXPECT_TRUE(std::ranges::any_of(
          all,
          [&](const DocumentedElement& one) {
            if (parent != one.parent || name != one.name) return false;
            return one.values.empty() || std::ranges::find(one.values, value) != one.values.end();
          }))
          << parent << "/" << name << "=" << value;
    }
    EXPECT_EQ(turns, written.mission.flight->waypoints - 2);
    EXPECT_EQ(pitches, written.mission.flight->waypoints - 1);
    EXPECT_EQ(starts, 1U);
    EXPECT_EQ(stops, 1U);
  }
}

}  // namespace
}  // namespace skycap::missions
