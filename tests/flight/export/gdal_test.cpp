// GDAL's ogrinfo, if installed, is an independent reader of the map formats.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>

#include "flight/export/map_files.h"
#include "tests/flight/export/sample_plan.h"
#include "tests/support/temporary_folder.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Longitude, latitude and height of each vertex, for each shape of one kind.
using Shapes = std::vector<std::vector<Vector3d>>;

class Gdal : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v ogrinfo > /dev/null 2>&1") != 0) GTEST_SKIP() << "no ogrinfo";
  }

  /// Returns the output of ogrinfo for a file with this content.
  std::string report(const std::string& name, const std::string& content) const {
    const std::filesystem::path path = folder_.file(name, content);
    const std::string command = "ogrinfo -ro -al " + path.string() + " 2>&1";
    std::FILE* pipe = popen(command.c_str(), "r");
    std::string text;
    std::array<char, 4096> buffer;
    while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr) {
      text += buffer.data();
    }
    EXPECT_EQ(pclose(pipe), 0) << text;
    return text;
  }

  testing_support::TemporaryFolder folder_;
};

/// Returns the shapes in the well-known text of ogrinfo, such as "POINT Z (1 2 3)".
Shapes shapes(const std::string& report, const std::string& kind) {
  Shapes found;
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t start = line.find_first_not_of(' ');
    if (start == std::string::npos || line.compare(start, kind.size() + 4, kind + " Z (") != 0) {
      continue;
    }
    std::string numbers = line.substr(start + kind.size() + 4);
    for (char& c : numbers) {
      if (c == ',' || c == '(' || c == ')') c = ' ';
    }
    std::istringstream stream(numbers);
    std::vector<Vector3d> positions;
    for (Vector3d p; stream >> p.x() >> p.y() >> p.z();) positions.push_back(p);
    found.push_back(positions);
  }
  return found;
}

/// 1e-8 degrees correspond to 1 mm, and heights are written in millimetres.
void expect_at(const Vector3d& read, const FlightPlan& plan, const Vector3d& position,
               double undulation) {
  const GeodeticPoint geodetic = LocalFrame(plan.site.origin).to_geodetic(position);
  EXPECT_NEAR(read.x(), geodetic.longitude_deg, 1e-8);
  EXPECT_NEAR(read.y(), geodetic.latitude_deg, 1e-8);
  EXPECT_NEAR(read.z(), geodetic.height - undulation, 1e-3);
}

void expect_flight(const std::string& report, const FlightPlan& plan, double undulation) {
  const Shapes lines = shapes(report, "LINESTRING"), points = shapes(report, "POINT");
  ASSERT_GE(lines.size(), 1U) << report;
  ASSERT_EQ(lines[0].size(), plan.waypoints.size());
  std::size_t capture_point = 0;
  for (std::size_t i = 0; i < plan.waypoints.size(); ++i) {
    expect_at(lines[0][i], plan, plan.waypoints[i].position, undulation);
    if (!plan.waypoints[i].is_capture_point) continue;
    ASSERT_LT(capture_point, points.size());
    expect_at(points[capture_point++].at(0), plan, plan.waypoints[i].position, undulation);
  }
  EXPECT_EQ(capture_point, points.size());
}

TEST_F(Gdal, ReadsExportedGeoJson) {
  const FlightPlan plan = sample_plan(vehicle_profile("generic"));
  const std::string text = report("mission.geojson", write_geojson(plan));
  expect_flight(text, plan, 0.0);
  // The path, the waypoints, the fence and the two no-fly volumes.
  EXPECT_NE(text.find("Feature Count: 8"), std::string::npos) << text;
  EXPECT_EQ(shapes(text, "POINT").size(), 4U);
  EXPECT_NE(text.find("WGS 84"), std::string::npos);
}

TEST_F(Gdal, ReadsExportedKml) {
  const FlightPlan plan = sample_plan(vehicle_profile("generic"));
  const std::string text = report("mission.kml", write_kml(plan));
  expect_flight(text, plan, *plan.site.geoid_undulation);
  EXPECT_EQ(shapes(text, "POLYGON").size(), plan.no_fly.size());
}

}  // namespace
}  // namespace skycap::flight
