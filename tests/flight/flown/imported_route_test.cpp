// Routes from elsewhere: units, datums, hostile rows, KML and logs.
#include "flight/flown/imported_route.h"

#include <cmath>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/geodesy.h"
#include "flight/export/text.h"
#include "flight/flown/track_simplification.h"
#include "geometry/error.h"
#include "tests/flight/flown/flown_logs.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::TemporaryFolder;
using testing_support::thrown_message;

const Site site{{47.1, 8.2, 480.0}, 48.0};
const Vector3d pad(-20.0, 5.0, 1.0);

FlightFacts make_facts() {
  FlightFacts facts;
  facts.site = site;
  facts.pad = pad;
  return facts;
}

ImportedRoute read(const std::string& name, const std::string& content,
                   TrackHeights heights = TrackHeights::automatic) {
  const TemporaryFolder folder;
  return read_imported_route(folder.file(name, content), make_facts(), true, heights);
}

std::string message(const std::string& name, const std::string& content,
                    TrackHeights heights = TrackHeights::automatic) {
  return thrown_message([&] { read(name, content, heights); });
}

/// Returns "latitude,longitude" of a position in the mission's frame.
std::string lat_lon(const Vector3d& position) {
  const GeodeticPoint point = LocalFrame(site.origin).to_geodetic(position);
  return fixed(point.latitude_deg, 9) + "," + fixed(point.longitude_deg, 9);
}

double ellipsoid_height(const Vector3d& position) {
  return LocalFrame(site.origin).to_geodetic(position).height;
}

TEST(ImportedRoute, ReadsWaypointTablesInTheMissionFrameWithoutAGeoreference) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& rows) {
    const std::string text = "x,y,z,heading_deg,gimbal_pitch_deg,photos\n" + rows;
    return read_imported_route(folder.file("route.csv", text), FlightFacts{}, false,
                               TrackHeights::automatic);
  };
  const ImportedRoute route = read("1.5,-2,30,270,-45,1\r\n\n4,5,6,0,0,0\n");
  ASSERT_EQ(route.points.size(), 2U);
  EXPECT_FALSE(route.is_track);
  EXPECT_EQ(route.points[0].position, Vector3d(1.5, -2, 30));
  EXPECT_EQ(route.points[0].yaw_deg, 270);
  EXPECT_EQ(route.points[0].pitch_deg, -45);
  EXPECT_EQ(route.points[0].captures, 1);
  EXPECT_EQ(route.points[1].captures, 0);
  EXPECT_EQ(route.points[1].item, "line 4");
  for (const char* row : {"1,2,3,4,5", "1,2,3,4,5,6,7", "1,2,x,0,0,0", "nan,2,3,0,0,0",
                          "1,2,3,400,0,0", "1,2,3,0,0,0.5", "1,2,3,0,0,-1", "1e9,2,3,0,0,0"}) {
    EXPECT_THAT(thrown_message([&] { read(std::string("1,2,3,0,0,1\n") + row + "\n"); }),
                HasSubstr("line 3"))
        << row;
  }
  EXPECT_THROW(read(""), Error);
}

TEST(ImportedRoute, ReadsTheVehiclesOfAFleet) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& rows) {
    const std::string text = "x,y,z,heading_deg,gimbal_pitch_deg,photos,vehicle\n" + rows;
    return read_imported_route(folder.file("route.csv", text), FlightFacts{}, false,
                               TrackHeights::automatic);
  };
  const ImportedRoute route = read("1,2,3,0,0,1,2\n4,5,6,0,0,1,1\n");
  ASSERT_EQ(route.points.size(), 2U);
  EXPECT_EQ(route.points[0].vehicle, 2U);
  EXPECT_EQ(route.points[1].vehicle, 1U);
  for (const char* row : {"1,2,3,0,0,1", "1,2,3,0,0,1,0", "1,2,3,0,0,1,1.5", "1,2,3,0,0,1,x"}) {
    EXPECT_THAT(thrown_message([&] { read(row); }), HasSubstr("line 2")) << row;
  }
}

TEST(ImportedRoute, ReadsHeadingsAndPitchesOfWaypointTables) {
  const Vector3d first(10, 20, 31), second(30, -10, 41);
  const double above_pad = ellipsoid_height(first) - ellipsoid_height(pad);
  const ImportedRoute route =
      read("table.csv", "lat,lon,height,heading,gimbal_pitch,hold,photo\n" + lat_lon(first) + "," +
                            fixed(above_pad, 4) + ",90,-35,2.5,1\n" + lat_lon(second) +
                            ",40,,,,false\n");
  EXPECT_FALSE(route.is_track);
  EXPECT_TRUE(route.is_above_takeoff);
  EXPECT_EQ(route.heights, "above take-off");
  ASSERT_EQ(route.points.size(), 2U);
  EXPECT_LT((route.points[0].position - first).norm(), 1e-3);
  EXPECT_EQ(route.points[0].yaw_deg, 90.0);
  EXPECT_EQ(route.points[0].pitch_deg, -35.0);
  EXPECT_EQ(route.points[0].hold, 2.5);
  EXPECT_EQ(route.points[0].captures, 1);
  EXPECT_EQ(route.points[0].item, "line 2");
  EXPECT_TRUE(std::isnan(route.points[1].yaw_deg));
  EXPECT_TRUE(std::isnan(route.points[1].pitch_deg));
  EXPECT_EQ(route.points[1].captures, 0);
}

TEST(ImportedRoute, ConvertsUnitsAndDatums) {
  const Vector3d position(10, 20, 31);
  const double ellipsoid = ellipsoid_height(position);
  const double amsl = ellipsoid - 48.0, above_pad = ellipsoid - ellipsoid_height(pad);
  const auto height_of = [&](const std::string& column, double value,
                             TrackHeights heights = TrackHeights::automatic) {
    const ImportedRoute route =
        read("table.csv",
             "latitude;longitude;" + column + "\n" +
                 std::string(lat_lon(position)).replace(lat_lon(position).find(','), 1, ";") + ";" +
                 fixed(value, 6) + "\n",
             heights);
    return route.points.at(0).position.z();
  };
  constexpr double feet = 1.0 / 0.3048;
  EXPECT_NEAR(height_of("height(m)", above_pad), 31.0, 1e-3);
  EXPECT_NEAR(height_of("height(feet)", feet * above_pad), 31.0, 1e-3);
  EXPECT_NEAR(height_of("height_ft", feet * above_pad), 31.0, 1e-3);
  EXPECT_NEAR(height_of("altitude", amsl), 31.0, 1e-3);
  EXPECT_NEAR(height_of("altitude(ft)", feet * amsl), 31.0, 1e-3);
  EXPECT_NEAR(height_of("ellipsoid_height", ellipsoid), 31.0, 1e-3);
  // A column named altitude that is above take-off.
  EXPECT_NEAR(height_of("altitude", above_pad, TrackHeights::takeoff), 31.0, 1e-3);
}

TEST(ImportedRoute, SelectsTheColumnOfHeights) {
  const Vector3d position(10, 20, 31);
  const double amsl = ellipsoid_height(position) - 48.0;
  const std::string table =
      "lat,lon,height,altitude\n" + lat_lon(position) + ",12," + fixed(amsl, 6) + "\n";
  EXPECT_NEAR(read("a.csv", table).points[0].position.z(), 13.0, 0.01);  // 12 m above the pad
  EXPECT_NEAR(read("a.csv", table, TrackHeights::absolute).points[0].position.z(), 31.0, 1e-3);
  EXPECT_THAT(message("a.csv", "lat,lon,height\n47,8,12\n", TrackHeights::absolute),
              HasSubstr("a.csv: contains no absolute height; use --heights takeoff"));
}

TEST(ImportedRoute, RejectsHostileRowsWithTheirLine) {
  const std::string header = "# from a friend\nlat,lon,height,heading,gimbal_pitch,photo\n";
  const std::string good = "47.1,8.2,30,90,-10,1\n";
  const auto error_of = [&](const std::string& row) {
    return message("table.csv", header + good + row + "\n" + good);
  };
  for (const auto& [row, what] : std::vector<std::pair<std::string, std::string>>{
           {"north,8.2,30,90,-10,1", "\"north\" in the column lat"},
           {"97.1,8.2,30,90,-10,1", "\"97.1\" in the column lat; it must be a number from -90"},
           {"47.1,208.2,30,90,-10,1", "\"208.2\" in the column lon"},
           {"47.1,8.2,,90,-10,1", "has no value in the column height"},
           {"47.1,8.2", "has no value in the column height"},
           {"47.1,8.2,nan,90,-10,1", "\"nan\" in the column height"},
           {"47.1,8.2,1e9,90,-10,1", "\"1e9\" in the column height"},
           {"47.1,8.2,30,east,-10,1", "\"east\" in the column heading"},
           {"47.1,8.2,30,90,-270,1", "\"-270\" in the column gimbal_pitch"},
           {"47.1,8.2,30,90,-10,1.5", "integer number of photos"},
           {"0,0,30,90,-10,1", "has the position 0, 0"}}) {
    EXPECT_THAT(error_of(row), AllOf(HasSubstr("table.csv: line 4 "), HasSubstr(what))) << row;
  }
  EXPECT_THAT(message("table.csv", "x,y,z\n1,2,3\n"), HasSubstr("must name the columns latitude"));
  EXPECT_THAT(message("table.csv", header), HasSubstr("contains no waypoint"));
  EXPECT_THAT(message("table.csv", ""), HasSubstr("table.csv: contains no header line"));
}

TEST(ImportedRoute, RequiresAGeoreference) {
  const TemporaryFolder folder;
  const auto file = folder.file("table.csv", "lat,lon,height\n47.1,8.2,30\n");
  EXPECT_THAT(thrown_message(
                  [&] { read_imported_route(file, make_facts(), false, TrackHeights::automatic); }),
              HasSubstr("set site.latitude_deg and site.longitude_deg"));
}

std::string kml(const std::string& shapes) {
  return "<?xml version=\"1.0\"?><kml xmlns=\"http://www.opengis.net/kml/2.2\" "
         "xmlns:gx=\"http://www.google.com/kml/ext/2.2\"><Document>" +
         shapes + "</Document></kml>";
}

std::string lon_lat(const Vector3d& position, double height, char separator) {
  const GeodeticPoint point = LocalFrame(site.origin).to_geodetic(position);
  return fixed(point.longitude_deg, 9) + separator + fixed(point.latitude_deg, 9) + separator +
         fixed(height, 4);
}

TEST(ImportedRoute, ReadsLinesAndTracksOfKml) {
  const Vector3d first(10, 20, 31), second(30, -10, 41);
  const double amsl[] = {ellipsoid_height(first) - 48.0, ellipsoid_height(second) - 48.0};
  const std::string coordinates =
      lon_lat(first, amsl[0], ',') + "\n " + lon_lat(second, amsl[1], ',');
  const auto line = [&](const std::string& name, const std::string& mode) {
    return "<Placemark><name>" + name + "</name><LineString>" +
           (mode.empty() ? "" : "<altitudeMode>" + mode + "</altitudeMode>") + "<coordinates>" +
           coordinates + "</coordinates></LineString></Placemark>";
  };
  for (const std::string& content :
       {line("my route", "absolute"), line("other", "absolute") + line("path", "absolute")}) {
    const ImportedRoute route = read("route.kml", kml(content));
    ASSERT_EQ(route.points.size(), 2U);
    EXPECT_LT((route.points[0].position - first).norm(), 1e-3);
    EXPECT_LT((route.points[1].position - second).norm(), 1e-3);
    EXPECT_FALSE(route.is_track);
  }
  EXPECT_THAT(message("route.kml", kml(line("a", "absolute") + line("b", "absolute"))),
              HasSubstr("contains 2 lines"));
  for (const std::string mode : {"", "relativeToGround"}) {
    EXPECT_THAT(message("route.kml", kml(line("a", mode))),
                HasSubstr("use --heights takeoff or absolute"));
    EXPECT_EQ(read("route.kml", kml(line("a", mode)), TrackHeights::takeoff).heights,
              "above take-off");
  }
  EXPECT_THAT(message("route.kml", kml("<Placemark/>")), HasSubstr("neither a LineString nor"));
  EXPECT_THAT(message("route.kml", "<kml>"), HasSubstr("not well-formed XML"));

  const ImportedRoute track = read(
      "track.kml",
      kml("<Placemark><gx:Track><altitudeMode>absolute</altitudeMode><gx:coord>" +
          lon_lat(first, amsl[0], ' ') + "</gx:coord><gx:coord>" + lon_lat(second, amsl[1], ' ') +
          "</gx:coord><gx:angles>90 60 0</gx:angles><gx:angles>180 45 0</gx:angles></gx:Track>"
          "</Placemark>"));
  EXPECT_TRUE(track.is_track);
  ASSERT_EQ(track.points.size(), 2U);
  EXPECT_LT((track.points[1].position - second).norm(), 1e-3);
  EXPECT_EQ(track.points[0].yaw_deg, 90.0);
  EXPECT_EQ(track.points[0].pitch_deg, -30.0);  // tilt 60 degrees from straight down
  EXPECT_THAT(message("bad.kml", kml("<LineString><altitudeMode>absolute</altitudeMode>"
                                     "<coordinates>8.2,47.1,500 8.2,x,1</coordinates>"
                                     "</LineString>")),
              HasSubstr("point 2 is invalid"));
}

TEST(ImportedRoute, SimplifiesFlownLogsWithinTheTolerance) {
  const std::vector<Vector3d> corners{pad,           pad + Vector3d(0, 0, 10), {10, 20, 15},
                                      {30, -10, 12}, pad + Vector3d(0, 0, 10), pad};
  const std::vector<FlownState> flight = fly_polyline(corners, {2, 3});
  for (const auto& [name, content] : std::vector<std::pair<std::string, std::string>>{
           {"flight.bin", write_dataflash(flight, site, pad)},
           {"flight.ulg", write_ulog(flight, site, pad)}}) {
    ImportedRoute route = read(name, content);
    EXPECT_TRUE(route.is_track);
    EXPECT_TRUE(route.is_above_takeoff);
    // 9 m of climb and of descent at 4 m/s and 10 Hz, and the rest at the pad.
    EXPECT_GE(remove_pad_column(route, pad, 3.0, 9.0), 36U) << name;
    std::vector<TrackSample> samples;
    std::size_t captures = 0;
    for (const ImportedPoint& point : route.points) {
      samples.push_back(
          {point.time, point.position, point.yaw_deg, point.pitch_deg, point.captures > 0});
      captures += point.captures > 0 ? 1 : 0;
    }
    EXPECT_EQ(captures, 2U) << name;
    const SimplifiedTrack track = simplify_track(samples, {.tolerance = 0.4});
    EXPECT_LE(track.deviation, 0.4) << name;
    // Both ends above the pad, the corners there, and two captures with their arrival at most.
    EXPECT_GE(track.kept.size(), 4U) << name;
    EXPECT_LE(track.kept.size(), 10U) << name;
    for (const Vector3d& corner : {corners[2], corners[3]}) {
      const bool is_kept = std::ranges::any_of(track.kept, [&](std::size_t i) {
        return samples[i].is_kept && (samples[i].position - corner).norm() < 0.05;
      });
      EXPECT_TRUE(is_kept) << name;
    }
  }
}

TEST(ImportedRoute, SurvivesRandomDamage) {
  const std::string table = "lat,lon,height,heading,gimbal_pitch,photo\n" + lat_lon({10, 20, 31}) +
                            ",30,90,-20,1\n" + lat_lon({30, -10, 41}) + ",40,180,-30,0\n";
  const std::string line =
      kml("<Placemark><LineString><altitudeMode>absolute</altitudeMode>"
          "<coordinates>" +
          lon_lat({10, 20, 31}, 463, ',') + " " + lon_lat({30, -10, 41}, 473, ',') +
          "</coordinates></LineString></Placemark>");
  std::mt19937_64 random(52);
  std::size_t rejected = 0;
  for (int round = 0; round < 3000; ++round) {
    const bool is_table = round % 2 == 0;
    std::string text = is_table ? table : line;
    const std::size_t changes = 1 + random() % 4;
    for (std::size_t i = 0; i < changes; ++i) {
      const std::size_t at = random() % text.size();
      const auto byte = static_cast<char>(random() % 256);
      const std::size_t kind = random() % 3;
      if (kind == 0) text[at] = byte;
      if (kind == 1) text.erase(at, 1 + random() % 20);
      if (kind == 2) text.insert(at, 1 + random() % 3, byte);
      if (text.empty()) text = ",";
    }
    try {
      const GeodeticRoute route = is_table ? read_waypoint_table(text, TrackHeights::automatic)
                                           : read_kml_route(text, TrackHeights::automatic);
      ASSERT_EQ(route.points.size(), route.items.size());
      for (const FilePoint& point : route.points) {
        EXPECT_LE(std::abs(point.latitude_deg), 90.0);
        EXPECT_LE(std::abs(point.longitude_deg), 180.0);
        EXPECT_LE(std::abs(point.height), 10'000.0);
      }
    } catch (const Error& error) {
      EXPECT_FALSE(std::string(error.what()).empty());
      ++rejected;
    }
  }
  EXPECT_GT(rejected, 300U);
  EXPECT_LT(rejected, 3000U);
}

TEST(ImportedRoute, RemovesOnlyTheColumnOfThePad) {
  ImportedRoute route;
  const auto add = [&](const Vector3d& from_pad, int captures = 0) {
    ImportedPoint point;
    point.position = pad + from_pad;
    point.captures = captures;
    route.points.push_back(point);
  };
  add({0, 0, 0}), add({0.5, 0, 4}), add({0, 0, 12}), add({30, 0, 12});
  add({1, 0, 3}), add({30, 30, 12}), add({0, 0, 3}, 1), add({0, 0, 1});
  EXPECT_EQ(remove_pad_column(route, pad, 3.0, 5.0), 3U);  // first two and last
  EXPECT_EQ(route.points.size(), 5U);
  EXPECT_EQ(route.points.back().captures, 1);
}

}  // namespace
}  // namespace skycap::flight
