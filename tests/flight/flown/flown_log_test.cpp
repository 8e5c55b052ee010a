// Readers of flight logs: intact, truncated, with gaps and with random damage.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/flown/flown_readers.h"
#include "flight/flown/flown_track.h"
#include "geometry/error.h"
#include "tests/flight/flown/flown_logs.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::TemporaryFolder;
using testing_support::thrown_message;

const Site site{{47.1, 8.2, 480.0}, 48.0};
const Vector3d pad(-20.0, 5.0, 1.0);

/// Returns a flight from the pad to two captures and back.
std::vector<FlownState> sample_flight() {
  return fly_polyline(
      {pad, pad + Vector3d(0, 0, 10), {10, 20, 15}, {30, -10, 12}, pad + Vector3d(0, 0, 10), pad},
      {2, 3});
}

FlownTrack place(const FlownLog& log, TrackHeights heights = TrackHeights::automatic) {
  return place_track(log, site, true, pad, heights);
}

FlownTrack read(const std::string& name, const std::string& content) {
  const TemporaryFolder folder;
  return place(read_flown_log(folder.file(name, content)));
}

/// Expects the captures at their positions and in their directions, and the track without the rest
/// on the ground.
void expect_sample_flight(const FlownTrack& track, bool has_pitch) {
  EXPECT_THAT(track.warnings, IsEmpty());
  ASSERT_EQ(track.captures.size(), 2);
  EXPECT_LT((track.captures[0].position - Vector3d(10, 20, 15)).norm(), 0.02);
  EXPECT_LT((track.captures[1].position - Vector3d(30, -10, 12)).norm(), 0.02);
  EXPECT_NEAR(track.captures[0].yaw_deg, 0.0, 0.01);
  if (has_pitch) {
    EXPECT_NEAR(track.captures[0].camera_pitch_deg, -20.0, 0.01);
    EXPECT_NEAR(std::remainder(track.captures[0].camera_yaw_deg, 360.0), 0.0, 0.01);
  } else {
    EXPECT_TRUE(std::isnan(track.captures[0].camera_pitch_deg));
  }
  const std::vector<FlownState> flight = sample_flight();
  const double duration = flight.back().state.time - flight.front().state.time;
  EXPECT_NEAR(track.states.back().time - track.states.front().time, duration - 4.0, 1.0);
}

TEST(FlownLog, ReadsDataflashLayouts) {
  for (const auto layout :
       {DataflashLayout::copter_3_6_of_2019, DataflashLayout::copter_4_1_of_2021,
        DataflashLayout::copter_4_6_of_2025}) {
    SCOPED_TRACE(static_cast<int>(layout));
    const FlownTrack track =
        read("00000012.BIN", write_dataflash(sample_flight(), site, pad, layout));
    expect_sample_flight(track, layout == DataflashLayout::copter_4_6_of_2025);
    EXPECT_EQ(track.heights, "above take-off");
  }
}

TEST(FlownLog, ReadsDataflashBeforeCopter3_3) {
  const FlownTrack track = read(
      "12.BIN", write_dataflash(sample_flight(), site, pad, DataflashLayout::copter_3_2_of_2014));
  EXPECT_THAT(track.warnings, IsEmpty());
  EXPECT_FALSE(track.has_captures);
  const auto high = std::ranges::max_element(
      track.states, {}, [](const TrackState& state) { return state.position.z(); });
  ASSERT_NE(high, track.states.end());
  EXPECT_LT((high->position - Vector3d(10, 20, 15)).norm(), 0.02);
  EXPECT_NEAR(high->yaw_deg, 0.0, 0.01);
  const std::vector<FlownState> flight = sample_flight();
  EXPECT_NEAR(track.states.back().time - track.states.front().time,
              flight.back().state.time - flight.front().state.time - 4.0, 1.0);
}

TEST(FlownLog, ReadsSubtitlesWithoutLabels) {
  // The third number is the number of satellites. Only a longitude can exceed 90 degrees.
  const auto subtitles = [](const std::string& first, const std::string& second) {
    return "1\n00:00:01,000 --> 00:00:02,000\nHOME(149.0251,-20.2532) 2017.08.05 14:11:51\n" +
           first + "\n\n2\n00:00:02,000 --> 00:00:03,000\n" + second + "\n";
  };
  const TemporaryFolder folder;
  const auto states = [&](const std::string& content) {
    return read_flown_log(folder.file("a.srt", content)).states;
  };
  const auto old =
      states(subtitles("GPS(8.2,47.1,16) BAROMETER:1.9", "GPS(8.3,47.1,16) BAROMETER:-2"));
  ASSERT_EQ(old.size(), 2);
  EXPECT_EQ(old[0].location, Vector3d(47.1, 8.2, 1.9));
  EXPECT_EQ(old[1].location, Vector3d(47.1, 8.3, -2.0));
  EXPECT_EQ(old[0].above_takeoff, 1.9);
  EXPECT_EQ(old[1].time, 2.0);
  const auto swapped = states(
      subtitles("GPS(39.9,116.4,69.8) BAROMETER(91.2)", "GPS(39.8,116.4,69.8) BAROMETER(91.3)"));
  ASSERT_EQ(swapped.size(), 2);
  EXPECT_EQ(swapped[0].location, Vector3d(39.9, 116.4, 91.2));
}

TEST(FlownLog, NamesAMissingFix) {
  const TemporaryFolder folder;
  // Receivers without a fix report 0, 0.
  std::vector<FlownState> flight = sample_flight();
  for (FlownState& flown : flight) flown.state.position.head<2>().setZero();
  const std::string log = write_dataflash(flight, Site{{0.0, 0.0, 0.0}, 0.0}, Vector3d::Zero(),
                                          DataflashLayout::copter_3_2_of_2014);
  EXPECT_THAT(thrown_message([&] { read_flown_log(folder.file("a.bin", log)); }),
              HasSubstr("contains no position: the receiver had no three-dimensional fix"));
}

TEST(FlownLog, ReadsUlogLayouts) {
  for (const auto layout : {UlogLayout::px4_1_9_of_2019, UlogLayout::px4_1_16_of_2025}) {
    SCOPED_TRACE(static_cast<int>(layout));
    expect_sample_flight(read("log.ulg", write_ulog(sample_flight(), site, pad, layout)),
                         layout == UlogLayout::px4_1_16_of_2025);
  }
}

TEST(FlownLog, PlacesAbsoluteHeights) {
  const TemporaryFolder folder;
  // A barometer that drifts by 2 m: both heights agree only above take-off.
  const FlownLog log = read_flown_log(
      folder.file("a.bin", write_dataflash(sample_flight(), site, pad + Vector3d(0, 0, 2))));
  EXPECT_NEAR(place(log, TrackHeights::absolute).captures[0].position.z(), 15.0, 0.01);
  EXPECT_NEAR(place(log, TrackHeights::takeoff).captures[0].position.z(), 13.0, 0.01);
}

TEST(FlownLog, ReadsTablesOfDji) {
  const LocalFrame frame(site.origin);
  std::string csv =
      "time(millisecond),latitude,longitude,height_above_takeoff(feet),"
      "compass_heading(degrees),gimbal_pitch(degrees),isPhoto\n";
  std::string mrk;
  int photo = 0;
  for (const FlownState& flown : sample_flight()) {
    const GeodeticPoint point = frame.to_geodetic(flown.state.position);
    char line[200];
    std::snprintf(line, sizeof line, "%.0f,%.9f,%.9f,%.4f,%.1f,%.1f,%d\n", 1e3 * flown.state.time,
                  point.latitude_deg, point.longitude_deg,
                  (flown.state.position.z() - pad.z()) / 0.3048, flown.state.yaw_deg,
                  flown.state.camera_pitch_deg, flown.is_capture ? 1 : 0);
    csv += line;
    if (!flown.is_capture) continue;
    std::snprintf(line, sizeof line,
                  "%d\t%.6f\t[2100]\t   -6,N\t    -5,E\t    98,V\t%.9f,Lat\t%.9f,Lon\t%.3f,Ellh\t"
                  "0.01, 0.01, 0.02\t50,Q\n",
                  ++photo, 4e5 + flown.state.time, point.latitude_deg, point.longitude_deg,
                  point.height);
    mrk += line;
  }
  const FlownTrack table = read("flight.csv", csv);
  ASSERT_EQ(table.captures.size(), 2);
  EXPECT_LT((table.captures[1].position - Vector3d(30, -10, 12)).norm(), 0.02);
  EXPECT_NEAR(table.captures[1].camera_pitch_deg, -20.0, 1e-9);
  const FlownTrack photos = read("DJI_Timestamp.MRK", mrk);
  ASSERT_EQ(photos.captures.size(), 2);
  EXPECT_LT((photos.captures[1].position - Vector3d(30, -10, 12)).norm(), 0.02);
  EXPECT_EQ(photos.heights, "above the ellipsoid");
}

TEST(FlownLog, ReadsTracksWithoutCaptures) {
  const LocalFrame frame(site.origin);
  std::string gpx = "<?xml version=\"1.0\"?><gpx><trk><trkseg>", srt;
  int number = 0;
  for (const Vector3d& position : {Vector3d(0, 0, 10), Vector3d(10, 0, 10), Vector3d(10, 10, 10)}) {
    const GeodeticPoint point = frame.to_geodetic(position);
    char line[300];
    std::snprintf(line, sizeof line,
                  "<trkpt lat=\"%.9f\" lon=\"%.9f\"><ele>%.3f</ele>"
                  "<time>2026-05-01T10:00:0%d.500Z</time></trkpt>",
                  point.latitude_deg, point.longitude_deg, point.height - 48.0, number);
    gpx += line;
    std::snprintf(line, sizeof line,
                  "%d\n00:00:0%d,000 --> 00:00:0%d,033\n<font>[latitude: %.9f] [longitude: %.9f] "
                  "[rel_alt: %.3f abs_alt: %.3f]</font>\n\n",
                  number + 1, number, number, point.latitude_deg, point.longitude_deg, 9.0,
                  point.height - 48.0);
    srt += line;
    ++number;
  }
  gpx += "</trkseg></trk></gpx>";
  for (const auto& [name, text] : {std::pair("a.gpx", gpx), std::pair("a.srt", srt)}) {
    const FlownTrack track = read(name, text);
    ASSERT_EQ(track.states.size(), 3) << name;
    EXPECT_LT((track.states[2].position - Vector3d(10, 10, 10)).norm(), 0.01) << name;
    EXPECT_NEAR(track.states[2].time - track.states[0].time, 2.0, 1e-6) << name;
    EXPECT_FALSE(track.has_captures) << name;
  }
}

TEST(FlownLog, ReadsPosesOfTum) {
  // The camera looks east: its z axis is the x axis of the mission.
  const FlownTrack track = read("a.tum", "0 1 2 3 -0.5 0.5 -0.5 0.5\n1 5 2 3 -0.5 0.5 -0.5 0.5\n");
  ASSERT_EQ(track.states.size(), 2);
  EXPECT_NEAR(track.states[0].camera_yaw_deg, 90.0, 1e-6);
  EXPECT_NEAR(track.states[0].camera_pitch_deg, 0.0, 1e-6);
}

TEST(FlownLog, RejectsEncryptedRecordsAndOtherFiles) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& name, const std::string& content) {
    return thrown_message([&] { read_flown_log(folder.file(name, content)); });
  };
  EXPECT_THAT(message("DJIFlightRecord_2026-05-01_[10-00-00].txt", "\x01\x02"),
              HasSubstr("encrypted DJI flight record; export it as CSV"));
  EXPECT_THAT(message("FLY042.DAT", "BUILD"), HasSubstr("encrypted DJI flight log (.DAT)"));
  EXPECT_THAT(message("a.bin", "hello"), HasSubstr("is not an ArduPilot dataflash log"));
  EXPECT_THAT(message("a.csv", "a,b\n1,2\n"), HasSubstr("must name the columns latitude"));
  EXPECT_THAT(message("a.ulg", "ULog"), HasSubstr("is not a PX4 ULog"));
  EXPECT_THAT(message("a.zip", "PK\x03\x04"), HasSubstr("zip archive"));
}

TEST(FlownLog, ReadsUpToTruncation) {
  const std::vector<FlownState> flight = sample_flight();
  for (const bool is_ulog : {false, true}) {
    const std::string whole =
        is_ulog ? write_ulog(flight, site, pad) : write_dataflash(flight, site, pad);
    const std::string cut = whole.substr(0, whole.size() / 2 + 7);
    const FlownTrack track = read(is_ulog ? "a.ulg" : "a.bin", cut);
    EXPECT_THAT(track.warnings, Contains(HasSubstr("last message is incomplete")));
    // Half of the states, without the 2 s on the ground.
    EXPECT_NEAR(static_cast<double>(track.states.size()),
                0.5 * static_cast<double>(flight.size()) - 20.0,
                0.06 * static_cast<double>(flight.size()));
  }
}

TEST(FlownLog, ReportsGapsAndDamage) {
  std::vector<FlownState> flight = sample_flight();
  flight.erase(flight.begin() + 60, flight.begin() + 110);  // 5 s
  for (const bool is_ulog : {false, true}) {
    std::string log = is_ulog ? write_ulog(flight, site, pad) : write_dataflash(flight, site, pad);
    for (std::size_t i = log.size() * 3 / 4; i < log.size() * 3 / 4 + 300; ++i) log[i] = '\x55';
    const FlownTrack track = read(is_ulog ? "a.ulg" : "a.bin", log);
    EXPECT_THAT(track.warnings, Contains(HasSubstr("1 gap without positions, 5.1 s"))) << is_ulog;
    EXPECT_THAT(track.warnings, Contains(HasSubstr("damaged bytes skipped"))) << is_ulog;
    EXPECT_EQ(track.captures.size(), 2) << is_ulog;
    EXPECT_LT((track.states.back().position - pad).norm(), 1.5) << is_ulog;
  }
}

/// A file that spans several pieces gives the same track as one that is read at once.
TEST(FlownLog, ReadsLogsInPieces) {
  std::vector<Vector3d> points{pad};
  for (int i = 0; i < 250; ++i) points.emplace_back(40.0 * (i % 2), 5.0 * i, 20.0);
  const std::vector<FlownState> flight = fly_polyline(points, {5, 50, 249});
  for (const bool is_ulog : {false, true}) {
    const std::string log =
        is_ulog ? write_ulog(flight, site, pad) : write_dataflash(flight, site, pad);
    ASSERT_GT(log.size(), std::size_t{2} << 20);
    const FlownTrack track = read(is_ulog ? "a.ulg" : "a.bin", log);
    EXPECT_THAT(track.warnings, IsEmpty());
    ASSERT_EQ(track.captures.size(), 3);
    EXPECT_NEAR(static_cast<double>(track.states.size()), static_cast<double>(flight.size()), 60.0);
    EXPECT_LT((track.captures[2].position - points[249]).norm(), 0.02);
  }
}

/// Random damage gives a track or one error message, and no other failure.
TEST(FlownLog, SurvivesRandomDamage) {
  const std::vector<FlownState> flight = sample_flight();
  std::mt19937 random(7);
  const auto below = [&](std::size_t count) { return random() % count; };
  for (const bool is_ulog : {false, true}) {
    const std::string whole =
        is_ulog ? write_ulog(flight, site, pad) : write_dataflash(flight, site, pad);
    std::size_t readable = 0;
    for (int run = 0; run < 300; ++run) {
      std::string log = whole;
      const std::size_t changes = 1 + below(20);
      for (std::size_t k = 0; k < changes; ++k) {
        const std::size_t at = below(log.size());
        const std::size_t kind = below(4);
        if (kind == 0) log[at] = static_cast<char>(below(256));
        if (kind == 1) log.erase(at, 1 + below(40));
        if (kind == 2) log.insert(at, log.substr(below(log.size()), below(200)));
        if (kind == 3 && below(10) == 0) log.resize(1 + at);
      }
      std::istringstream stream(log);
      const std::string message = thrown_message([&] {
        const FlownLog read = is_ulog ? read_ulog_track(stream) : read_dataflash_track(stream);
        const FlownTrack track = place(read);
        ++readable;
        for (std::size_t i = 1; i < track.states.size(); ++i) {
          ASSERT_TRUE(track.states[i].position.allFinite());
          ASSERT_GE(track.states[i].time, track.states[i - 1].time);
        }
      });
      EXPECT_THAT(message, testing::Not(HasSubstr("\n")));
    }
    EXPECT_GT(readable, 150) << is_ulog;
  }
}

}  // namespace
}  // namespace skycap::flight
