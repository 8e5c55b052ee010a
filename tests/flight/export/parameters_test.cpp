#include "flight/export/parameters.h"

#include <map>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/wpml_file.h"
#include "geometry/error.h"
#include "tests/flight/export/sample_plan.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

FlightPlan make_plan(const char* vehicle) {
  FlightPlan plan = sample_plan(vehicle_profile(vehicle));
  plan.returns->height = 47.0;
  return plan;
}

/// Parses like Mission Planner (ParamFile.loadParamFile). Lines are split at commas, tabs and
/// spaces, "#" starts a comment line, and names have at most 16 characters as in MAVLink's
/// PARAM_SET.
std::map<std::string, double> read_as_mission_planner(const std::string& text) {
  std::map<std::string, double> values;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::size_t comma = line.find(',');
    EXPECT_NE(comma, std::string::npos) << line;
    EXPECT_LE(comma, 16U) << line;
    EXPECT_TRUE(values.emplace(line.substr(0, comma), std::stod(line.substr(comma + 1))).second)
        << line << " is there twice";
  }
  return values;
}

/// Parses like QGroundControl (ParameterManager::readParametersFromStream): five fields separated
/// by tabs, the type 6 (int32) or 9 (float), integers without a fraction.
std::map<std::string, double> read_as_qgroundcontrol(const std::string& text) {
  std::map<std::string, double> values;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with('#')) continue;
    std::vector<std::string> fields;
    std::istringstream parts(line);
    for (std::string field; std::getline(parts, field, '\t');) fields.push_back(field);
    EXPECT_EQ(fields.size(), 5U) << line;
    if (fields.size() != 5) continue;
    EXPECT_EQ(fields[0], "1");
    EXPECT_EQ(fields[1], "1");
    EXPECT_LE(fields[2].size(), 16U) << line;
    EXPECT_TRUE(fields[4] == "6" || fields[4] == "9") << line;
    EXPECT_TRUE(fields[4] != "6" || fields[3].find('.') == std::string::npos) << line;
    values[fields[2]] = std::stod(fields[3]);
  }
  return values;
}

// Centimetres under the old names, metres under the names since 4.7.
TEST(Parameters, SetArduPilotReturnAltitudeUnderBothNames) {
  const auto values = read_as_mission_planner(write_parameters(make_plan("generic_ardupilot")));
  EXPECT_EQ(values.at("RTL_ALT"), 4700);
  EXPECT_EQ(values.at("RTL_ALT_M"), 47);
  EXPECT_EQ(values.at("RTL_CONE_SLOPE"), 0);
  EXPECT_EQ(values.at("RTL_CLIMB_MIN"), 0);
  EXPECT_EQ(values.at("RTL_SPEED"), 400);
  EXPECT_EQ(values.at("RTL_SPEED_MS"), 4);
  EXPECT_EQ(values.at("FS_THR_ENABLE"), 1);
  EXPECT_EQ(values.at("FS_GCS_ENABLE"), 1);
  EXPECT_EQ(values.at("BATT_FS_LOW_ACT"), 2);
  EXPECT_EQ(values.at("FENCE_ENABLE"), 1);
  EXPECT_EQ(values.at("FENCE_TYPE"), 5);  // the sample fence has a ceiling and corners
  EXPECT_EQ(values.at("FENCE_ALT_MAX"), 60);
}

TEST(Parameters, SetNoArduPilotRallyDistanceLimit) {
  FlightPlan plan = make_plan("generic_ardupilot");
  EXPECT_FALSE(read_as_mission_planner(write_parameters(plan)).contains("RALLY_LIMIT_KM"));
  plan.returns->rtl_profile.landings.emplace_back(35.0, 20.0, 0.0);
  const auto values = read_as_mission_planner(write_parameters(plan));
  EXPECT_EQ(values.at("RALLY_LIMIT_KM"), 0.0);
  EXPECT_EQ(values.at("RALLY_INCL_HOME"), 1.0);
}

TEST(Parameters, SetPx4ReturnAltitude) {
  const auto values = read_as_qgroundcontrol(write_parameters(make_plan("generic")));
  EXPECT_EQ(values.at("RTL_RETURN_ALT"), 47);
  EXPECT_EQ(values.at("RTL_CONE_ANG"), 0);
  EXPECT_EQ(values.at("RTL_TYPE"), 0);
  EXPECT_EQ(values.at("NAV_ACC_RAD"), 1);
  EXPECT_EQ(values.at("NAV_RCL_ACT"), 2);
  EXPECT_EQ(values.at("NAV_DLL_ACT"), 2);
  EXPECT_EQ(values.at("COM_LOW_BAT_ACT"), 3);
  EXPECT_GE(values.at("BAT_CRIT_THR"), 0.07);
  EXPECT_EQ(values.at("GF_ACTION"), 3);
}

TEST(Parameters, RoundTripThroughFile) {
  for (const char* vehicle : {"generic_ardupilot", "generic"}) {
    const FlightPlan plan = make_plan(vehicle);
    const AutopilotType autopilot = plan.vehicle.autopilot;
    const std::vector<Parameter> read = read_parameters(write_parameters(plan));
    EXPECT_EQ(return_height(read, autopilot), 47.0);
    EXPECT_THAT(return_problems(read, autopilot), IsEmpty());
    const auto reference = autopilot == AutopilotType::px4
                               ? read_as_qgroundcontrol(write_parameters(plan))
                               : read_as_mission_planner(write_parameters(plan));
    EXPECT_EQ(read.size(), reference.size());
    for (const Parameter& parameter : read)
      EXPECT_EQ(reference.at(parameter.name), parameter.value);
  }
}

TEST(Parameters, ReportSettingsThatChangeTheReturn) {
  for (const Parameter& radius : {Parameter{"WPNAV_RADIUS", 50}, {"WP_RADIUS_M", 0.5}}) {
    EXPECT_THAT(return_problems({{"RTL_ALT", 4700}, {"RTL_CONE_SLOPE", 0}, radius},
                                AutopilotType::ardupilot),
                IsEmpty());
  }
  EXPECT_THAT(return_problems({{"RTL_ALT", 4700}}, AutopilotType::ardupilot),
              ElementsAre("RTL_CONE_SLOPE is 3; it must be 0",
                          "WPNAV_RADIUS is 200; it must be from 5 to 50"));
  EXPECT_THAT(
      return_problems(
          {{"RTL_ALT", 4700}, {"RTL_ALT_M", 4700}, {"RTL_CONE_SLOPE", 0}, {"WP_RADIUS_M", 0.5}},
          AutopilotType::ardupilot),
      ElementsAre("RTL_ALT is 4700 cm and RTL_ALT_M 4700 m; they must be equal"));
  EXPECT_THAT(return_problems({{"RTL_RETURN_ALT", 47}, {"RTL_CONE_ANG", 0}}, AutopilotType::px4),
              ElementsAre("NAV_ACC_RAD is 10; it must be from 0.05 to 1",
                          "NAV_MC_ALT_RAD is 0.8; it must be from 0.05 to 0.3"));
}

// mode_rtl.cpp: the return altitude is at most FENCE_ALT_MAX - FENCE_MARGIN.
TEST(Parameters, KeepTheArduPilotReturnBelowTheFence) {
  FlightPlan plan = make_plan("generic_ardupilot");
  const double ground = plan.pad.z();
  for (const double ceiling : {47.2, 48.0, 48.9, 49.0, 50.5, 60.0}) {
    plan.fence->ceiling = ground + ceiling;
    const auto values = read_as_mission_planner(write_parameters(plan));
    const bool has_altitude = (static_cast<int>(values.at("FENCE_TYPE")) & 1) != 0;
    EXPECT_EQ(has_altitude, ceiling >= 48.0) << ceiling;
    EXPECT_EQ(values.contains("FENCE_ALT_MAX"), has_altitude);
    if (!has_altitude) continue;
    EXPECT_LE(values.at("FENCE_ALT_MAX"), ceiling);
    EXPECT_GE(values.at("FENCE_MARGIN"), 1.0);
    EXPECT_GE(values.at("FENCE_ALT_MAX") - values.at("FENCE_MARGIN"), values.at("RTL_ALT_M"));
  }
}

// mission_block.cpp accepts waypoints without their heading if MIS_YAW_TMT is positive.
TEST(Parameters, LetPx4ReachStopsExactly) {
  const auto values = read_as_qgroundcontrol(write_parameters(make_plan("generic")));
  EXPECT_LT(values.at("MIS_YAW_TMT"), 0.0);
  EXPECT_LE(values.at("NAV_MC_ALT_RAD"), acceptance_radius);
}

TEST(Parameters, RejectInvalidLine) {
  try {
    read_parameters("# fine\nRTL_ALT,4700\nRTL_CONE_SLOPE=0\n");
    FAIL() << "must not be taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("line 3 is \"RTL_CONE_SLOPE=0\""));
  }
}

TEST(Parameters, RequireVerifiedReturns) {
  FlightPlan plan = make_plan("generic");
  plan.returns.reset();
  EXPECT_THAT(testing_support::thrown_message([&] { write_parameters(plan); }),
              testing::HasSubstr("has no verified return"));
  EXPECT_THAT(testing_support::thrown_message([&] { write_parameters(make_plan("m350_rtk")); }),
              testing::HasSubstr("does not use parameter files"));
}

// With a ceiling, altitudes may not be whole metres. Files and summaries contain the same value.
TEST(ReturnAltitude, IsWrittenWithAllDecimals) {
  EXPECT_EQ(return_altitude_text(62.0), "62");
  EXPECT_EQ(return_altitude_text(42.7), "42.7");
  EXPECT_EQ(return_altitude_text(11.25), "11.25");
  FlightPlan plan = sample_plan(vehicle_profile("m350_rtk"));
  plan.returns->height = 42.7;
  EXPECT_EQ(read_kmz(write_kmz(plan)).return_height, 42.7);
  FlightPlan own = sample_plan(vehicle_profile("generic_ardupilot"));
  own.returns->height = 42.7;
  EXPECT_EQ(return_height(read_parameters(write_parameters(own)), AutopilotType::ardupilot), 42.7);
}

}  // namespace
}  // namespace skycap::flight
