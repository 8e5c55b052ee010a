// Commands of a KMZ file for a laser scanner, as read by the interpreter.
#include "flight/interpreter/recording.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pugixml.hpp>

#include "flight/export/map_files.h"
#include "flight/export/scanner_commands.h"
#include "flight/export/wpml_file.h"
#include "flight/interpreter/verified_export.h"
#include "flight/interpreter/wpml_interpreter.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "tests/flight/export/sample_plan.h"
#include "tests/support/temporary_folder.h"

namespace skycap::flight {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double degree = geometry::radians_per_degree;

/// Scanner mount that points to the left of the nose and 30 degrees down.
const ScannerAim to_the_left{.azimuth = 0.5 * std::numbers::pi, .pitch = -30.0 * degree};

FlightPlan plan_with(int payload) {
  FlightPlan plan = sample_plan(vehicle_profile("m350_rtk"));
  for (Waypoint& waypoint : plan.waypoints) {
    waypoint.captures = 0;
    if (waypoint.is_capture_point) waypoint.pitch = 0.0;
    waypoint.hold = corner_hold;
    waypoint.hold_after = 0.0;
  }
  plan.vehicle.wpml.payload = payload;
  return plan;
}

constexpr double plenty = 1e9;  // Energy that is always sufficient [J].

const FlightPlan& commanded() {
  static const FlightPlan plan = [] {
    std::vector<std::string> notes;
    FlightPlan made =
        with_scanner_commands(plan_with(zenmuse_l2), Format::kmz, to_the_left, plenty, notes);
    EXPECT_THAT(notes, IsEmpty());
    return made;
  }();
  return plan;
}

const KmzContent& good() {
  static const KmzContent content = unpack_kmz(write_kmz(commanded()));
  return content;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << "nothing to replace: " << from;
  return position == std::string::npos ? text : text.replace(position, from.size(), to);
}

Problems problems_with(const std::string& from, const std::string& to) {
  return interpret({good().template_kml, replaced(good().waylines_wpml, from, to)},
                   make_flight_facts(commanded()))
      .problems;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t number = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++number;
  }
  return number;
}

TEST(Recording, KmzOfAScannerIsRecordedAndLooksWhereThePlanDoes) {
  EXPECT_THAT(interpret(good(), make_flight_facts(commanded())).problems, IsEmpty());
  EXPECT_THAT(validate_kmz(write_kmz(commanded())), IsEmpty());
}

TEST(Recording, KmzIsWrittenAfterVerification) {
  const testing_support::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "mission.kmz";
  const ExportResult result =
      export_flight(commanded(), Format::kmz, KnownSpace(sample_site()), file);
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_THAT(result.captures, IsEmpty());
}

// The file is checked against the scanner directions on the airframe of the plan.
TEST(Recording, HeadingAndGimbalTakeThePlaceOfTheMount) {
  const FlightPlan plan = plan_with(zenmuse_l2);
  const std::vector<geometry::View> observations = make_flight_facts(commanded()).views;
  std::size_t number = 0;
  for (const Waypoint& waypoint : plan.waypoints) {
    if (!waypoint.is_capture_point) continue;
    ASSERT_LT(number, observations.size());
    const geometry::View& observation = observations[number++];
    // The nose is along the yaw. The mount is directed 90 degrees to the left and 30 degrees down.
    const Eigen::Vector3d nose(std::sin(waypoint.yaw), std::cos(waypoint.yaw), 0.0);
    const Eigen::Vector3d left(-nose.y(), nose.x(), 0.0);
    const Eigen::Vector3d right_look =
        std::cos(30.0 * degree) * left - std::sin(30.0 * degree) * Eigen::Vector3d::UnitZ();
    EXPECT_LT((observation.direction - right_look).norm(), 1e-9);
    EXPECT_LT((observation.position - waypoint.position).norm(), 1e-9);
  }
  EXPECT_EQ(number, observations.size());
}

TEST(Recording, KmzNamesThePayloadAndItsSettings) {
  for (const std::string& text : {good().template_kml, good().waylines_wpml}) {
    EXPECT_THAT(text, HasSubstr("<wpml:payloadEnumValue>84</wpml:payloadEnumValue>"));
    EXPECT_EQ(count(text, ">startRecord<"), 1U);
    EXPECT_EQ(count(text, ">stopRecord<"), 1U);
    EXPECT_THAT(text, Not(HasSubstr("takePhoto")));
  }
  EXPECT_THAT(good().template_kml, HasSubstr("<wpml:samplingRate>240000"));
  EXPECT_THAT(good().template_kml, HasSubstr("<wpml:scanningMode>nonRepetitive"));
}

/// Elements of scanner commands with the values that DJI's WPML documentation lists (common
/// elements: payloadInfo, payloadParam, actionTrigger, gimbalRotate, hover, recordPointCloud).
/// payloadEnumValue: 90742 (L1) in the edition of 2022 and in DJI's WPMZ library, 84 (EP810, the
/// L2) in that library. An empty list stands for numbers above the minimum.
struct DocumentedElement {
  const char* parent;
  const char* name;
  std::vector<std::string> values;
  double min = -std::numeric_limits<double>::infinity();
};

const std::vector<DocumentedElement>& documented_elements() {
  static const std::vector<std::string> flag{"0", "1"};
  static const std::vector<DocumentedElement> elements{
      {"payloadInfo", "payloadEnumValue", {"90742", "84"}},
      {"payloadInfo", "payloadSubEnumValue", {"0"}},
      {"payloadInfo", "payloadPositionIndex", {"0", "1", "2"}},
      {"payloadParam", "payloadPositionIndex", {"0", "1", "2"}},
      {"payloadParam", "imageFormat", {"wide", "zoom", "ir", "narrow_band", "visible", "visable"}},
      {"payloadParam", "returnMode", {"singleReturnStrongest", "dualReturn", "tripleReturn"}},
      {"payloadParam", "samplingRate", {"60000", "80000", "120000", "160000", "180000", "240000"}},
      {"payloadParam", "scanningMode", {"repetitive", "nonRepetitive"}},
      {"payloadParam", "modelColoringEnable", flag},
      {"actionTrigger",
       "actionTriggerType",
       {"reachPoint", "betweenAdjacentPoints", "multipleTiming", "multipleDistance"}},
      {"action", "actionId", {}, 0.0},
      {"action", "actionActuatorFunc", {"gimbalRotate", "hover", "recordPointCloud"}},
      {"hover", "hoverTime", {}, 1e-3},
      {"recordPointCloud", "payloadPositionIndex", {"0", "1", "2"}},
      {"recordPointCloud",
       "recordPointCloudOperate",
       {"startRecord", "pauseRecord", "resumeRecord", "stopRecord"}},
      {"gimbalRotate", "gimbalHeadingYawBase", {"north"}},
      {"gimbalRotate", "gimbalRotateMode", {"relativeAngle", "absoluteAngle"}},
      {"gimbalRotate", "gimbalPitchRotateEnable", flag},
      {"gimbalRotate", "gimbalPitchRotateAngle", {}, -120.0},
      {"gimbalRotate", "gimbalRollRotateEnable", flag},
      {"gimbalRotate", "gimbalRollRotateAngle", {}, -180.0},
      {"gimbalRotate", "gimbalYawRotateEnable", flag},
      {"gimbalRotate", "gimbalYawRotateAngle", {}, -180.0},
      {"gimbalRotate", "gimbalRotateTimeEnable", flag},
      {"gimbalRotate", "gimbalRotateTime", {}, 0.0},
      {"gimbalRotate", "payloadPositionIndex", {"0", "1", "2"}},
  };
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

/// Returns the elements of scanner commands that are not documented, or have another value.
std::vector<std::string> undocumented(const std::string& text) {
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(text.c_str()));
  std::vector<std::string> found;
  std::size_t checked = 0;
  for (const pugi::xpath_node& match : document.select_nodes("//*[not(*)]")) {
    const std::string parent = local_name(match.node().parent());
    const auto& all = documented_elements();
    if (std::ranges::none_of(all, [&](const auto& one) { return parent == one.parent; })) continue;
    ++checked;
    const std::string name = local_name(match.node()), value = match.node().text().get();
    const bool is_right = std::ranges::any_of(all, [&](const DocumentedElement& one) {
      if (parent != one.parent || name != one.name) return false;
      if (one.values.empty()) return match.node().text().as_double(-1e9) >= one.min;
      return std::ranges::find(one.values, value) != one.values.end();
    });
    if (!is_right) found.push_back(parent + "/" + name + "=" + value);
  }
  EXPECT_GT(checked, 50U);
  return found;
}

TEST(Recording, WritesOnlyDocumentedElementsAndValues) {
  for (const int payload : {zenmuse_l1, zenmuse_l2}) {
    std::vector<std::string> notes;
    const FlightPlan plan =
        with_scanner_commands(plan_with(payload), Format::kmz, to_the_left, plenty, notes);
    const KmzContent content = unpack_kmz(write_kmz(plan));
    EXPECT_THAT(undocumented(content.template_kml), IsEmpty()) << payload;
    EXPECT_THAT(undocumented(content.waylines_wpml), IsEmpty()) << payload;
  }
  EXPECT_THAT(undocumented(replaced(good().template_kml, "nonRepetitive", "petal")),
              ElementsAre("payloadParam/scanningMode=petal"));
}

// The vehicle flies back and forth three times on the first and the last leg, which are verified.
TEST(Recording, ImuIsCalibratedOnVerifiedLegsAtBothEnds) {
  const std::vector<Waypoint>&before = plan_with(zenmuse_l2).waypoints,
        &after = commanded().waypoints;
  ASSERT_EQ(after.size(), before.size() + 4 * calibration_turns);
  const Eigen::Vector3d begin = before.front().position,
                        leg = (before[1].position - begin).normalized();
  for (std::size_t i = 0; i < 2 * calibration_turns; i += 2) {
    EXPECT_LT((after[i].position - begin).norm(), 1e-9);
    const Eigen::Vector3d out = after[i + 1].position - begin;
    EXPECT_NEAR(out.dot(leg), out.norm(), 1e-9);
    EXPECT_GE(out.norm(), min_calibration_length);
    EXPECT_LE(out.norm(), calibration_length + 1e-9);
  }
  const RecordedWaypoints recorded = recorded_waypoints(commanded());
  EXPECT_EQ(recorded.first, 2U * calibration_turns);
  EXPECT_EQ(recorded.last, after.size() - 1 - 2 * calibration_turns);
}

TEST(Recording, CalibrationIsLeftToThePilotWithoutEnergy) {
  std::vector<std::string> notes;
  const FlightPlan plan =
      with_scanner_commands(plan_with(zenmuse_l2), Format::kmz, to_the_left, 1000.0, notes);
  EXPECT_EQ(plan.waypoints.size(), plan_with(zenmuse_l2).waypoints.size());
  EXPECT_THAT(notes, ElementsAre(HasSubstr("calibrate the IMU of the Zenmuse L2 by hand")));
}

TEST(Recording, SpoiledFilesAreNoticed) {
  EXPECT_THAT(problems_with(">startRecord<", ">pauseRecord<"),
              Contains(HasSubstr("is not recorded by the Zenmuse L2")));
  EXPECT_THAT(problems_with("<wpml:gimbalPitchRotateAngle>-30", "<wpml:gimbalPitchRotateAngle>0"),
              Contains(HasSubstr("has a gimbal pitch of 0.0 degrees")));
  EXPECT_THAT(problems_with("<wpml:payloadEnumValue>84", "<wpml:payloadEnumValue>42"),
              Contains(HasSubstr("the Zenmuse L2 is 84")));
  std::string slow = good().waylines_wpml;
  for (std::size_t at = slow.find("<wpml:waypointSpeed>4.00"); at != std::string::npos;
       at = slow.find("<wpml:waypointSpeed>4.00")) {
    slow.replace(at, 24, "<wpml:waypointSpeed>3.00");
  }
  EXPECT_THAT(interpret({good().template_kml, slow}, make_flight_facts(commanded())).problems,
              Contains(HasSubstr("is flown at 3.00 m/s")));
  std::string ahead = good().waylines_wpml;
  for (std::size_t i = 0; (i = ahead.find("smoothTransition", i)) != std::string::npos;) {
    ahead.replace(i, 16, "followWayline");
  }
  EXPECT_THAT(interpret({good().template_kml, ahead}, make_flight_facts(commanded())).problems,
              Contains(HasSubstr("ends with a heading of")));
}

TEST(Recording, FormatsThatCannotCommandAPayloadNameIt) {
  std::vector<std::string> notes;
  for (const Format format : {Format::plan, Format::waypoints, Format::litchi}) {
    try {
      with_scanner_commands(plan_with(zenmuse_l2), format, to_the_left, plenty, notes);
      ADD_FAILURE() << format_info(format).name;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("cannot control the Zenmuse L2"));
    }
  }
  ScannerAim stopping = to_the_left;
  stopping.is_moving = false;
  EXPECT_THROW(with_scanner_commands(plan_with(zenmuse_l2), Format::kmz, stopping, plenty, notes),
               Error);
  EXPECT_NO_THROW(
      with_scanner_commands(plan_with(zenmuse_l2), Format::kml, to_the_left, plenty, notes));
}

// The scanner is fixed to the airframe. The file must not contain gimbal commands.
TEST(Recording, ScannersThatRecordByThemselvesAreLeftToThePilot) {
  std::vector<std::string> notes;
  const FlightPlan plan =
      with_scanner_commands(plan_with(psdk_payload), Format::kmz, to_the_left, plenty, notes);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("start the scanner recording before take-off")));
  const KmzContent kmz = unpack_kmz(write_kmz(plan));
  EXPECT_THAT(kmz.waylines_wpml, HasSubstr("<wpml:payloadEnumValue>65534"));
  EXPECT_THAT(kmz.waylines_wpml, Not(HasSubstr("gimbalRotate")));
  EXPECT_THAT(interpret(kmz, make_flight_facts(plan)).problems, IsEmpty());
}

}  // namespace
}  // namespace skycap::flight
