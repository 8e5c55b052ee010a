// Interpretation of corrupted DJI and Litchi files. Problems name the waypoint or the line.
#include "flight/interpreter/wpml_interpreter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/map_files.h"
#include "flight/interpreter/interpret.h"
#include "tests/flight/interpreter/spoiled.h"

namespace skycap::flight {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const FlightPlan& plan() {
  static const FlightPlan plan = sample_plan(vehicle_profile("m350_rtk"));
  return plan;
}

const KmzContent& good() {
  static const KmzContent content = unpack_kmz(write_kmz(plan()));
  return content;
}

/// Replaces the n-th occurrence of `from`.
std::string replaced(std::string text, const std::string& from, const std::string& to, int n = 0) {
  std::size_t offset = text.find(from);
  while (n-- > 0 && offset != std::string::npos) offset = text.find(from, offset + 1);
  EXPECT_NE(offset, std::string::npos) << "nothing to replace: " << from;
  return offset == std::string::npos ? text : text.replace(offset, from.size(), to);
}

Problems after(const KmzContent& kmz) {
  return find_problems(interpret(kmz, make_flight_facts(plan())));
}
Problems with_waylines(const std::string& from, const std::string& to, int n = 0) {
  return after({good().template_kml, replaced(good().waylines_wpml, from, to, n)});
}
Problems with_template(const std::string& from, const std::string& to, int n = 0) {
  return after({replaced(good().template_kml, from, to, n), good().waylines_wpml});
}
Problems with_both(const std::string& from, const std::string& to) {
  return after({replaced(good().template_kml, from, to), replaced(good().waylines_wpml, from, to)});
}

TEST(WpmlInterpreter, AcceptsExportedFiles) { EXPECT_THAT(after(good()), IsEmpty()); }

TEST(WpmlInterpreter, RejectsChangedMissionSettings) {
  const std::string end = "</wpml:";
  const auto setting = [&](const std::string& name, const std::string& value,
                           const std::string& other) {
    return with_waylines("<wpml:" + name + ">" + value + end, "<wpml:" + name + ">" + other + end);
  };
  const auto names = [](const std::string& what) {
    return Contains(AllOf(StartsWith("waylines.wpml has wpml:"), HasSubstr(what)));
  };
  EXPECT_THAT(setting("flyToWaylineMode", "safely", "pointToPoint"), names("pointToPoint"));
  EXPECT_THAT(setting("finishAction", "goHome", "gotoFirstWaypoint"), names("gotoFirstWaypoint"));
  EXPECT_THAT(setting("finishAction", "goHome", "noAction"), names("noAction"));
  EXPECT_THAT(setting("finishAction", "goHome", "autoLand"), IsEmpty());
  EXPECT_THAT(setting("exitOnRCLost", "executeLostAction", "goContinue"), names("goContinue"));
  EXPECT_THAT(setting("executeRCLostAction", "goBack", "landing"), names("landing"));
  EXPECT_THAT(setting("executeRCLostAction", "goBack", "hover"), names("hover"));
  EXPECT_THAT(setting("takeOffSecurityHeight", "5.00", "1.50"), names("at least 5.00 m"));
  EXPECT_THAT(setting("globalTransitionalSpeed", "4.00", "15"), names("15.00 m/s"));
  EXPECT_THAT(setting("autoFlightSpeed", "4.00", "15"), names("15.00 m/s"));
  const std::size_t height = good().waylines_wpml.find("<wpml:globalRTHHeight>");
  const std::size_t stop = good().waylines_wpml.find("</wpml:globalRTHHeight>");
  EXPECT_THAT(with_waylines(good().waylines_wpml.substr(height, stop - height),
                            "<wpml:globalRTHHeight>5.00"),
              names("highest waypoint"));
  // Pilot 2 regenerates the waylines from the template. Errors in the template therefore count as
  // well.
  EXPECT_THAT(with_template("<wpml:flyToWaylineMode>safely", "<wpml:flyToWaylineMode>pointToPoint"),
              Contains(StartsWith("template.kml has wpml:flyToWaylineMode")));
  EXPECT_THAT(with_template("<wpml:globalUseStraightLine>1", "<wpml:globalUseStraightLine>0"),
              Contains(HasSubstr("leaves the straight legs")));
  EXPECT_THAT(with_both("<wpml:droneEnumValue>89", "<wpml:droneEnumValue>77"),
              Contains(HasSubstr("\"m350_rtk\" has 89")));
}

TEST(WpmlInterpreter, ReportsProblemsWithWaypointIndex) {
  EXPECT_THAT(with_waylines("<wpml:useStraightLine>1", "<wpml:useStraightLine>0", 2),
              Contains(StartsWith("waypoint 2 has wpml:useStraightLine 0")));
  EXPECT_THAT(with_waylines("<wpml:waypointSpeed>4.00", "<wpml:waypointSpeed>15", 3),
              Contains(StartsWith("waypoint 3 has wpml:waypointSpeed 15.00")));
  EXPECT_THAT(
      with_waylines("<wpml:useStraightLine>", "<wpml:wind>1</wpml:wind><wpml:useStraightLine>", 1),
      Contains(StartsWith("waypoint 1 has wpml:wind, which is not supported")));
  EXPECT_THAT(with_template("<wpml:useGlobalTurnParam>1", "<wpml:useGlobalTurnParam>0", 2),
              Contains(StartsWith("waypoint 2 has wpml:useGlobalTurnParam 0")));
  EXPECT_THAT(with_template("<wpml:useGlobalHeight>0", "<wpml:useGlobalHeight>1", 2),
              Contains(StartsWith("waypoint 2 has wpml:useGlobalHeight 1")));
  EXPECT_THAT(with_waylines("<wpml:actionGroupEndIndex>1<", "<wpml:actionGroupEndIndex>4<"),
              Contains(StartsWith("waypoint 1 has wpml:actionGroupEndIndex 4")));
  EXPECT_THAT(with_waylines("reachPoint", "multipleTiming", 2),
              Contains(StartsWith("waypoint 2 has wpml:actionTriggerType")));
}

TEST(WpmlInterpreter, RejectsChangedCaptures) {
  EXPECT_THAT(with_waylines("<wpml:hoverTime>2.00", "<wpml:hoverTime>0.00"),
              Contains(HasSubstr("holds 0.00 s before its image")));
  std::string ahead = good().waylines_wpml;
  for (std::size_t i = 0; (i = ahead.find("smoothTransition", i)) != std::string::npos;) {
    ahead.replace(i, 16, "followWayline");
  }
  EXPECT_THAT(after({good().template_kml, ahead}),
              Contains(HasSubstr("captures an image without a heading")));
  EXPECT_THAT(with_waylines("<wpml:gimbalPitchRotateEnable>1", "<wpml:gimbalPitchRotateEnable>0"),
              Contains(HasSubstr("without a gimbal pitch")));
  EXPECT_THAT(with_waylines("<wpml:gimbalYawRotateEnable>0", "<wpml:gimbalYawRotateEnable>1"),
              Contains(HasSubstr("turns the gimbal")));
}

TEST(WpmlInterpreter, RejectsChangedTakeOffPoint) {
  const std::size_t start = good().template_kml.find("<wpml:takeOffRefPoint>");
  const std::size_t stop = good().template_kml.find("</wpml:takeOffRefPoint>");
  const std::string was = good().template_kml.substr(start, stop - start);
  const GeodeticPoint pad = position_at(plan().pad), elsewhere = position_at({-30, 35, 0});
  const auto reference = [&](const GeodeticPoint& offset, double up) {
    return with_template(was, "<wpml:takeOffRefPoint>" + degrees(offset.latitude_deg) + "," +
                                  degrees(offset.longitude_deg) + "," +
                                  fixed(offset.height + up, 3));
  };
  EXPECT_THAT(reference(pad, 0.0), IsEmpty());
  EXPECT_THAT(reference(pad, 30.0), Contains(HasSubstr("30.0 m vertically from")));
  EXPECT_THAT(reference(elsewhere, 0.0),
              Contains(HasSubstr("takeOffRefPoint is 60.0 m horizontally")));
}

// The vehicle climbs to the security height, flies level, and descends to the first waypoint, which
// is not above the pad.
TEST(WpmlInterpreter, IncludesPathToFirstWaypoint) {
  FlightPlan moved = plan();
  moved.waypoints.front().position = {14, -16, 8};
  FlightFacts facts = make_flight_facts(plan());
  const InterpretedRoute route = interpret(unpack_kmz(write_kmz(moved)), facts);
  ASSERT_GE(route.segments.size(), 2U);
  EXPECT_TRUE(route.segments[0].is_over_pad);
  bool comes_level = false;
  for (const InterpretedSegment& segment : route.segments) {
    comes_level = comes_level ||
                  (segment.from_item == "the take-off point" && segment.to_item == "waypoint 0" &&
                   (segment.to - Eigen::Vector3d(14, -16, 8)).norm() < 0.02);
  }
  EXPECT_TRUE(comes_level);
}

TEST(LitchiInterpreter, ReportsChangedSpeedsAndCurvesWithLineNumber) {
  const FlightPlan generic = sample_plan(vehicle_profile("generic"));
  const std::string text = write_litchi(generic);
  const auto with = [&](const std::string& from, const std::string& to) {
    return find_problems(
        interpret(replaced(text, from, to, 1), Format::litchi, make_flight_facts(generic)));
  };
  EXPECT_THAT(find_problems(interpret(text, Format::litchi, make_flight_facts(generic))),
              IsEmpty());
  EXPECT_THAT(with(",0.2,0,0,0", ",9.0,0,0,0"),
              Contains(StartsWith("line 3 has a curve of 9.0 m")));
  EXPECT_THAT(with(",0,4.00,", ",0,15.00,"),
              Contains(StartsWith("line 3 has a speed of 15.00 m/s")));
  EXPECT_THAT(with(",0,2000,", ",0,0,"), Contains(HasSubstr("holds 0.00 s before")));
}

}  // namespace
}  // namespace skycap::flight
