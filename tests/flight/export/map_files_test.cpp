// Validation rules of KMZ (WPML), KML, GeoJSON and Litchi CSV files. Each case breaks one rule.
#include "flight/export/map_files.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "flight/export/export.h"
#include "flight/export/wpml_file.h"
#include "geometry/error.h"
#include "tests/flight/export/sample_plan.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t offset = text.find(from);
  EXPECT_NE(offset, std::string::npos) << "nothing to replace: " << from;
  return offset == std::string::npos ? text : text.replace(offset, from.size(), to);
}

// ---- KMZ -------------------------------------------------------------------------------------

const KmzContent& good_kmz() {
  static const KmzContent content = unpack_kmz(write_kmz(sample_plan(vehicle_profile("m350_rtk"))));
  return content;
}
Problems with_waylines(const std::string& from, const std::string& to) {
  return validate_kmz(
      pack_kmz({good_kmz().template_kml, replaced(good_kmz().waylines_wpml, from, to)}));
}
Problems with_template(const std::string& from, const std::string& to) {
  return validate_kmz(
      pack_kmz({replaced(good_kmz().template_kml, from, to), good_kmz().waylines_wpml}));
}

TEST(Kmz, ReportsInvalidZipAndXml) {
  EXPECT_THAT(validate_kmz(pack_kmz(good_kmz())), IsEmpty());
  EXPECT_THAT(validate_kmz("PK but not really"), Contains(HasSubstr("not a zip")));
  EXPECT_THAT(validate_kmz(""), Contains(HasSubstr("template.kml is missing")));
  EXPECT_THAT(with_waylines("</Folder>", ""),
              Contains(HasSubstr("waylines.wpml is not well-formed")));
  EXPECT_THAT(with_waylines("opengis.net/kml/2.2", "opengis.net/kml/2.1"),
              Contains(HasSubstr("must be in the namespace")));
  EXPECT_THAT(with_template("www.dji.com/wpmz/1.0.6", "www.autel.com/wpmz/1.0.0"),
              Contains(HasSubstr("xmlns:wpml")));
  EXPECT_THAT(with_template("www.dji.com/wpmz/1.0.6", "www.dji.com/wpmz/1.0.2"),
              Contains(HasSubstr("template.kml and waylines.wpml differ")));
}

TEST(Kmz, ReportsInvalidMissionConfig) {
  EXPECT_THAT(with_waylines("<wpml:flyToWaylineMode>safely", "<wpml:flyToWaylineMode>boldly"),
              Contains(HasSubstr("flyToWaylineMode \"boldly\"")));
  EXPECT_THAT(with_waylines("<wpml:finishAction>goHome</wpml:finishAction>", ""),
              Contains(HasSubstr("has no wpml:finishAction")));
  EXPECT_THAT(with_waylines("<wpml:executeRCLostAction>goBack</wpml:executeRCLostAction>", ""),
              Contains(HasSubstr("has no wpml:executeRCLostAction")));
  EXPECT_THAT(with_waylines("<wpml:takeOffSecurityHeight>5.00", "<wpml:takeOffSecurityHeight>1.00"),
              Contains(HasSubstr("takeOffSecurityHeight 1.00")));
  EXPECT_THAT(
      with_waylines("<wpml:globalTransitionalSpeed>4.00", "<wpml:globalTransitionalSpeed>16"),
      Contains(HasSubstr("globalTransitionalSpeed 16")));
  EXPECT_THAT(with_waylines("<wpml:globalRTHHeight>", "<wpml:globalRTHHeight>x"),
              Contains(HasSubstr("globalRTHHeight")));
  EXPECT_THAT(with_waylines("<wpml:droneEnumValue>89", "<wpml:droneEnumValue>65535"),
              Contains(HasSubstr("droneEnumValue \"65535\"")));
  EXPECT_THAT(with_waylines("<wpml:payloadPositionIndex>0", "<wpml:payloadPositionIndex>3"),
              Contains(HasSubstr("payloadPositionIndex 3")));
}

TEST(Kmz, ReportsInvalidWaypoints) {
  EXPECT_THAT(
      with_waylines("<wpml:executeHeightMode>relativeToStartPoint", "<wpml:executeHeightMode>AGL"),
      Contains(HasSubstr("executeHeightMode \"AGL\"")));
  EXPECT_THAT(with_waylines("<wpml:index>1<", "<wpml:index>2<"),
              Contains(HasSubstr("it must be 1")));
  EXPECT_THAT(with_waylines("<coordinates>-1.25", "<coordinates>51.7,-1.25"),
              Contains(HasSubstr("longitude,latitude")));
  EXPECT_THAT(with_waylines("<wpml:waypointSpeed>4.00", "<wpml:waypointSpeed>0"),
              Contains(HasSubstr("waypointSpeed 0")));
  EXPECT_THAT(with_waylines("toPointAndStopWithDiscontinuityCurvature", "coordinateTurn"),
              Contains(HasSubstr("its clearance cannot be verified")));
  EXPECT_THAT(with_waylines("<wpml:waypointHeadingAngle>", "<wpml:waypointHeadingAngle>9"),
              Contains(HasSubstr("waypointHeadingAngle")));
  EXPECT_THAT(with_template("<wpml:height>", "<wpml:height>1"),
              Contains(HasSubstr("template.kml and waylines.wpml differ")));
  EXPECT_THAT(with_template("<wpml:ellipsoidHeight>", "<wpml:ellipsoidHeight>x"),
              Contains(HasSubstr("ellipsoidHeight")));
}

TEST(Kmz, ReportsInvalidActions) {
  EXPECT_THAT(with_waylines("<wpml:actionGroupId>1<", "<wpml:actionGroupId>0<"),
              Contains(HasSubstr("actionGroupId 0 twice")));
  EXPECT_THAT(with_waylines("<wpml:actionGroupEndIndex>1<", "<wpml:actionGroupEndIndex>0<"),
              Contains(HasSubstr("actionGroupEndIndex 0")));
  EXPECT_THAT(with_waylines("<wpml:actionGroupMode>sequence", "<wpml:actionGroupMode>parallel"),
              Contains(HasSubstr("actionGroupMode")));
  EXPECT_THAT(with_waylines("<wpml:actionTriggerType>reachPoint", "<wpml:actionTriggerType>never"),
              Contains(HasSubstr("actionTriggerType")));
  EXPECT_THAT(with_waylines("<wpml:gimbalPitchRotateAngle>", "<wpml:gimbalPitchRotateAngle>-9"),
              Contains(HasSubstr("gimbalPitchRotateAngle")));
  EXPECT_THAT(
      with_waylines("<wpml:actionActuatorFunc>gimbalRotate", "<wpml:actionActuatorFunc>dance"),
      Contains(HasSubstr("\"dance\"")));
  EXPECT_THAT(
      with_waylines("<wpml:actionActuatorFunc>gimbalRotate", "<wpml:actionActuatorFunc>rotateYaw"),
      Contains(HasSubstr("takePhoto without a gimbalRotate")));
}

TEST(Kmz, ContainsAnglesCapturesAndHoldsOfPlan) {
  const FlightPlan plan = sample_plan(vehicle_profile("m350_rtk"));
  const RouteFile route = read_kmz(write_kmz(plan));
  ASSERT_EQ(route.points.size(), plan.waypoints.size());
  for (std::size_t i = 0; i < route.points.size(); ++i) {
    EXPECT_EQ(route.points[i].datum, HeightDatum::takeoff);
    if (!plan.waypoints[i].is_capture_point) continue;
    EXPECT_NEAR(route.points[i].yaw_deg, plan.waypoints[i].yaw * 180 / M_PI, 1e-4);
    EXPECT_NEAR(route.points[i].pitch_deg, plan.waypoints[i].pitch * 180 / M_PI, 1e-4);
    EXPECT_EQ(route.points[i].captures, 2);
    EXPECT_EQ(route.points[i].hold, plan.waypoints[i].hold + plan.waypoints[i].hold_after);
  }
  EXPECT_THAT(
      testing_support::thrown_message([&] { write_kmz(sample_plan(vehicle_profile("generic"))); }),
      testing::HasSubstr("does not support DJI missions"));
}

// ---- KML -------------------------------------------------------------------------------------

TEST(Kml, ReportsInvalidElements) {
  const FlightPlan plan = sample_plan(vehicle_profile("generic"));
  const std::string good = write_kml(plan);
  const auto with = [&](const std::string& from, const std::string& to) {
    return validate_kml(replaced(good, from, to));
  };
  EXPECT_THAT(validate_kml(good), IsEmpty());
  EXPECT_THAT(with("</Document>", ""), Contains(HasSubstr("not well-formed")));
  EXPECT_THAT(with("opengis.net/kml/2.2", "google.com/earth/kml/2"),
              Contains(HasSubstr("kml element")));
  EXPECT_THAT(with("<altitudeMode>absolute</altitudeMode>", ""),
              Contains(HasSubstr("must be absolute")));
  EXPECT_THAT(with("<coordinates>-1", "<coordinates> , -1"),
              Contains(HasSubstr("longitude,latitude,height")));
  EXPECT_THAT(with("<name>path</name>", "<name>way</name>"),
              Contains(HasSubstr("missing Placemark \"path\"")));
  EXPECT_THAT(with("<when>2000", "<when>2001"),
              Contains(HasSubstr("has times that are not in ascending order")));
  EXPECT_THAT(with("<gx:coord>", "<gx:coord>0 0 0</gx:coord><gx:coord>"),
              Contains(HasSubstr("as many gx:coord elements as when elements")));
  EXPECT_THAT(with("<tilt>", "<tilt>9"), Contains(HasSubstr("tilt")));
  EXPECT_THAT(with("<LinearRing>\n            <coordinates>",
                   "<LinearRing>\n            <coordinates>0,0,0 "),
              Contains(HasSubstr("end with its first one")));
  // Altitudes are AMSL: the ellipsoidal height minus the undulation of 46.7 m.
  const RouteFile route = read_kml(good);
  EXPECT_EQ(route.points[0].datum, HeightDatum::mean_sea_level);
  EXPECT_NEAR(route.points[0].height, 111.5 - 46.7 + plan.waypoints[0].position.z(), 1e-2);
}

// ---- GeoJSON ---------------------------------------------------------------------------------

TEST(GeoJson, ReportsInvalidFeatures) {
  using nlohmann::json;
  const std::string good = write_geojson(sample_plan(vehicle_profile("generic")));
  const auto after = [&](const std::function<void(json&)>& change) {
    json file = json::parse(good);
    change(file);
    return validate_geojson(file.dump());
  };
  const auto last = [](json& file) -> json& {
    return file["features"][file["features"].size() - 1]["geometry"]["coordinates"][0];
  };
  EXPECT_THAT(validate_geojson(good), IsEmpty());
  EXPECT_THAT(validate_geojson("{}"), Contains(HasSubstr("not a GeoJSON")));
  EXPECT_THAT(after([](json& f) { f["crs"] = "EPSG:4326"; }), Contains(HasSubstr("crs")));
  EXPECT_THAT(after([](json& f) { f["features"][0].erase("properties"); }),
              Contains(HasSubstr("features[0]")));
  EXPECT_THAT(after([](json& f) {
                f["features"][1]["geometry"]["coordinates"] = {95, 200};
              }),
              Contains(HasSubstr("features[1] has a position")));
  EXPECT_THAT(after([](json& f) {
                f["features"][0]["geometry"]["coordinates"] = {{1, 2, 3}};
              }),
              Contains(HasSubstr("fewer than two")));
  EXPECT_THAT(after([](json& f) { f["features"][0]["geometry"]["coordinates"][1].erase(2); }),
              Contains(HasSubstr("without a height")));
  EXPECT_THAT(after([](json& f) { f["features"].erase(0); }), Contains(HasSubstr("no LineString")));
  EXPECT_THAT(after([&](json& f) { last(f).erase(last(f).size() - 1); }),
              Contains(HasSubstr("not closed")));
  EXPECT_THAT(after([&](json& f) { std::reverse(last(f).begin(), last(f).end()); }),
              Contains(HasSubstr("wrong direction")));
}

TEST(GeoJson, WritesCapturePointHeightsForEveryKnownDatum) {
  FlightPlan plan = sample_plan(vehicle_profile("generic"));
  const auto capture_point = [&] {
    return nlohmann::json::parse(write_geojson(plan))["features"][1];
  };
  const nlohmann::json known = capture_point();
  const double ellipsoid = known["geometry"]["coordinates"][2];
  EXPECT_NEAR(known["properties"]["height_amsl_m"].get<double>(), ellipsoid - 46.7, 1e-6);
  EXPECT_NEAR(known["properties"]["height_takeoff_m"].get<double>(), 7.25, 1e-3);
  plan.site.geoid_undulation.reset();
  EXPECT_TRUE(capture_point()["properties"]["height_amsl_m"].is_null());
}

// ---- Litchi ----------------------------------------------------------------------------------

TEST(Litchi, ReportsInvalidRows) {
  const FlightPlan plan = sample_plan(vehicle_profile("generic"));
  const std::string good = write_litchi(plan);
  const auto with = [&](const std::string& from, const std::string& to) {
    return validate_litchi(replaced(good, from, to));
  };
  EXPECT_THAT(validate_litchi(good), IsEmpty());
  EXPECT_THAT(with("heading(deg)", "heading"), Contains(HasSubstr("header")));
  EXPECT_THAT(with(",-1,0,-1,0", ",-1,0"), Contains(HasSubstr("all 15 actions")));
  EXPECT_THAT(with("\n51.", "\n151."), Contains(HasSubstr("latitude 151")));
  EXPECT_THAT(with(",-1,-1\n", ",-1,nan\n"), Contains(HasSubstr("\"nan\"")));
  EXPECT_THAT(with(",0,4.00,", ",1,4.00,"), Contains(HasSubstr("altitudemode")));
  EXPECT_THAT(with(",0,4.00,", ",0,40.00,"), Contains(HasSubstr("speed 40")));
  const RouteFile route = read_litchi(good);
  ASSERT_FALSE(route.points.empty());
  for (std::size_t i = 0; i < route.points.size(); ++i) {
    if (!plan.waypoints[i].is_capture_point) continue;
    EXPECT_NEAR(route.points[i].yaw_deg, plan.waypoints[i].yaw * 180 / M_PI, 1e-4);
    EXPECT_NEAR(route.points[i].pitch_deg, plan.waypoints[i].pitch * 180 / M_PI, 0.5);
    EXPECT_EQ(route.points[i].captures, 2);
    EXPECT_EQ(route.points[i].hold, plan.waypoints[i].hold + plan.waypoints[i].hold_after);
  }
}

TEST(Litchi, RejectsTooManyCapturesOrWaypoints) {
  FlightPlan plan = sample_plan(vehicle_profile("generic"));
  plan.waypoints[1].captures = 20;
  EXPECT_THAT(testing_support::thrown_message([&] { write_litchi(plan); }),
              testing::HasSubstr("a waypoint with 20 photos cannot be written for Litchi"));
  plan = sample_plan(vehicle_profile("generic"));
  plan.waypoints.resize(120, plan.waypoints[0]);
  EXPECT_THAT(testing_support::thrown_message([&] { write_litchi(plan); }),
              testing::HasSubstr("has 120 waypoints; the maximum for Litchi is 99"));
}

TEST(Litchi, AcceptsTheMaximumNumberOfWaypointsAndRejectsOneMore) {
  FlightPlan plan = sample_plan(vehicle_profile("generic"));
  plan.waypoints.resize(99, plan.waypoints[0]);
  EXPECT_EQ(split_plan(plan, Format::litchi).size(), 1U);
  const std::string text = write_litchi(plan);
  EXPECT_THAT(validate_litchi(text), IsEmpty());
  const std::string last_line = text.substr(text.rfind('\n', text.size() - 2) + 1);
  EXPECT_THAT(validate_litchi(text + last_line), Contains(HasSubstr("too many waypoints: 100")));
  plan.waypoints.push_back(plan.waypoints[0]);
  EXPECT_THAT(testing_support::thrown_message([&] { write_litchi(plan); }),
              HasSubstr("has 100 waypoints; the maximum for Litchi is 99"));
  const std::vector<FlightPlan> parts = split_plan(plan, Format::litchi);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].waypoints.size(), 99U);
  EXPECT_EQ(parts[1].waypoints.size(), 2U);  // begins at the last waypoint of the first part
}

TEST(Kmz, AcceptsTheMaximumNumberOfWaypointsAndRejectsOneMore) {
  FlightPlan plan = sample_plan(vehicle_profile("m350_rtk"));
  plan.vehicle.max_waypoints = 200;
  plan.waypoints.resize(200, plan.waypoints[0]);
  EXPECT_FALSE(write_kmz(plan).empty());
  plan.waypoints.push_back(plan.waypoints[0]);
  EXPECT_THAT(testing_support::thrown_message([&] { write_kmz(plan); }),
              HasSubstr("has 201 waypoints; vehicle \"m350_rtk\" accepts 200"));
}

}  // namespace
}  // namespace skycap::flight
