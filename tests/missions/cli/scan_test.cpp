// End-to-end tests of `skycap scan`.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "flight/export/utm.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/mesh_io.h"
#include "geometry/points/depth_image.h"
#include "missions/scan/preview.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/scan/las_file.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3f;
using testing::HasSubstr;
using tests::ProgramRun;
using tests::run_skycap;
using tests::TestFolder;

/// 0.1 s of flight around a cube of 2 m on the ground.
class ScanCommand : public testing::Test {
 protected:
  ScanCommand() {
    folder.write("cube.obj",
                 "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\n"
                 "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    folder.write("laser.yaml",
                 "name: Test laser\nkind: spinning\ncolumns_per_turn: 500\nrotation_rate_hz: 20\n"
                 "channels: {count: 16, lowest_deg: -20, highest_deg: 10}\n"
                 "range: {min: 0.1, max: 50}\nerrors: {sigma: 0.01}\n");
    mission = folder.write("cube.yaml",
                           "scene: {model: cube.obj}\n"
                           "scan:\n"
                           "  sensor: laser.yaml\n"
                           "  orbit: {radius: 5, min_height: 1, circles: 1, speed: 100}\n"
                           "evaluation: {coverage_distance: 0.1}\n");
  }

  ProgramRun scan(std::vector<std::string> options = {}, std::stop_token stop = {}) const {
    options.insert(options.begin(), {"scan", mission, "--out", folder / "out"});
    return run_skycap(options, false, std::move(stop));
  }
  nlohmann::json summary() const {
    return nlohmann::json::parse(tests::read_content(folder / "out/scan.json"));
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    if (!std::filesystem::exists(folder / "out")) return names;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "out")) {
      names.push_back(entry.path().filename());
    }
    std::ranges::sort(names);
    return names;
  }
  /// Returns the largest distance between a point and the surface of the cube.
  static float largest_error(const std::vector<Vector3f>& points) {
    float largest = 0.0F;
    for (const Vector3f& point : points) {
      const Vector3f from_middle = (point - Vector3f(0, 0, 1)).cwiseAbs();
      largest = std::max(largest, std::abs(from_middle.maxCoeff() - 1.0F));
    }
    return largest;
  }

  const TestFolder folder;
  std::string mission;
};

// A name may have the maximum length of folder names. The text after it must not be lost.
TEST_F(ScanCommand, PrintsWholeSummaryWithLongName) {
  const std::string name(250, 'n');
  const ProgramRun run = scan({"--set", "name=" + name});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, testing::StartsWith(name + ": Test laser, 0.3 s of flight\n"));
  EXPECT_THAT(run.out, HasSubstr(" M pulses/s\n  results   "));
}

TEST_F(ScanCommand, WritesCloudTrajectoriesAndSummary) {
  const ProgramRun run = scan();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("cube: Test laser, 0.3 s of flight"));
  EXPECT_THAT(files(), testing::ElementsAre("preview.ply", "scan.html", "scan.json", "scan.las",
                                            "trajectory.tum", "trajectory_estimated.tum"));
  const nlohmann::json json = summary();
  // 2 pi 5 m at 100 m/s, with 16 pulses every 100 microseconds.
  EXPECT_EQ(json["shots"], 16 * 3141);
  EXPECT_EQ(json["complete"], true);
  EXPECT_EQ(json["files"][0]["bytes"], std::filesystem::file_size(folder / "out/scan.las"));
}

TEST_F(ScanCommand, WritesMeasuredAndTruePoints) {
  const ProgramRun run =
      scan({"--format", "ply", "--with-truth", "--set", "scan.navigation.horizontal_sigma=0.2"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto measured = geometry::read_cloud(folder / "out/scan.ply").positions;
  const auto truth = geometry::read_cloud(folder / "out/scan_true.ply").positions;
  ASSERT_EQ(measured.size(), summary()["points"]);
  ASSERT_EQ(truth.size(), measured.size());
  ASSERT_GT(truth.size(), 1000U);
  EXPECT_LT(largest_error(truth), 1e-5F);    // single precision at 5 m
  EXPECT_GT(largest_error(measured), 0.1F);  // the position error is about 0.2 m
  EXPECT_NE(tests::read_content(folder / "out/trajectory.tum"),
            tests::read_content(folder / "out/trajectory_estimated.tum"));
}

// Without platform errors, only the range noise of 0.01 m remains.
TEST_F(ScanCommand, HasOnlySensorNoiseWithPerfectNavigation) {
  ASSERT_EQ(scan({"--format", "ply"}).exit_code, 0);
  const auto measured = geometry::read_cloud(folder / "out/scan.ply").positions;
  EXPECT_LT(largest_error(measured), 0.067F);  // normal random numbers are limited to 6.7 sigma
  EXPECT_GT(largest_error(measured), 0.02F);
  EXPECT_EQ(tests::read_content(folder / "out/trajectory.tum"),
            tests::read_content(folder / "out/trajectory_estimated.tum"));
}

// The preview contains all of these few pulses. The flight of 0.314 s has six revolutions of 50 ms
// and an incomplete one.
TEST_F(ScanCommand, WritesPreviewWithPointsAndPieces) {
  ASSERT_EQ(scan({"--format", "ply"}).exit_code, 0);
  const auto preview = geometry::read_cloud(folder / "out/preview.ply");
  EXPECT_EQ(preview.positions, geometry::read_cloud(folder / "out/scan.ply").positions);
  EXPECT_TRUE(std::ranges::is_sorted(preview.views));
  EXPECT_EQ(preview.views.front(), 0U);
  EXPECT_EQ(preview.views.back(), 6U);
  EXPECT_EQ(summary()["preview"]["piece_s"], 0.05);
}

TEST_F(ScanCommand, RegeneratesHtmlReport) {
  ASSERT_EQ(scan().exit_code, 0);
  const std::string page = tests::read_content(folder / "out/scan.html");
  EXPECT_THAT(page, HasSubstr("\"kind\":\"scan\""));
  std::filesystem::remove(folder / "out/scan.html");
  const ProgramRun again = run_skycap({"report", folder / "out"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(tests::read_content(folder / "out/scan.html") == page);
  ASSERT_EQ(scan({"--no-report"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/scan.html"));
  for (const char* text : {"", "[]", "{}", "{\"mission\": 3}"}) {
    folder.write("out/scan.json", text);
    const ProgramRun bad = run_skycap({"report", folder / "out"});
    EXPECT_EQ(bad.exit_code, 2) << text;
    EXPECT_THAT(bad.err, HasSubstr("scan.json")) << text;
  }
}

// A tenth of consecutive pulses in each channel: 1000 of 10,000, within six standard deviations of
// 30.
TEST(Preview, SelectsFractionOfEachChannel) {
  for (std::uint64_t channel = 0; channel < 16; ++channel) {
    int chosen = 0;
    for (std::uint64_t time = 0; time < 10'000; ++time) {
      chosen += scan::is_previewed(time, channel, 0.1) ? 1 : 0;
    }
    EXPECT_NEAR(chosen, 1000, 180) << channel;
  }
  EXPECT_TRUE(scan::is_previewed(5, 7, 1.0));
  EXPECT_EQ(scan::preview_share(100.0), 1.0);
  EXPECT_DOUBLE_EQ(scan::preview_share(15e6), 0.1);
}

TEST_F(ScanCommand, ScansRouteFileWithNamedSensor) {
  const std::string route = folder.write("route.tum",
                                         "0.0 5 0 1 0 0 0 1\n"
                                         "0.1 5 1 1 0 0 0 1\n");
  const ProgramRun run = scan({"--route", route, "--sensor", "ideal_spinning", "--format", "xyz"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(summary()["shots"], 64 * 1024);  // pulses per revolution
  EXPECT_EQ(summary()["sensor"], "Ideal spinning scanner");
  EXPECT_LT(largest_error(geometry::read_cloud(folder / "out/scan.xyz").positions), 6e-5F);
}

// The top of the cube is lead and its sides are chalk. The ground has the material of the mission.
TEST_F(ScanCommand, ComputesIntensitiesFromMaterials) {
  folder.write("chalk.obj",
               "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\n"
               "f 4 3 2 1\nusemtl lead\nf 5 6 7 8\nusemtl chalk\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n"
               "f 4 1 5 8\n");
  const std::string materials = folder.write("materials.yaml", "lead: 0.1\nchalk: 0.9\n");
  const std::string route = folder.write("route.tum", "0 4 0 4 0 0 0 1\n0.1 4 1 4 0 0 0 1\n");
  const std::vector<std::string> options = {"--route",  route,
                                            "--format", "xyz",
                                            "--sensor", "ideal_spinning",
                                            "--set",    "scene.model=chalk.obj",
                                            "--set",    "scene.materials=materials.yaml",
                                            "--set",    "scene.reflectance=0.3",
                                            "--set",    "scan.mount.rotation_deg=[0, 25, 0]"};
  ASSERT_EQ(scan(options).exit_code, 0);
  std::istringstream lines(tests::read_content(folder / "out/scan.xyz"));
  std::string line;
  std::getline(lines, line);
  float brightest_lid = 0.0F, brightest_side = 0.0F;
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    float x = 0, y = 0, z = 0, intensity = 0;
    fields >> x >> y >> z >> intensity;
    const bool is_lid = std::abs(x) < 0.99F && std::abs(y) < 0.99F;
    float& brightest = is_lid ? brightest_lid : brightest_side;
    brightest = std::max(brightest, intensity);
  }
  // Intensity is reflectance times the cosine of the incidence angle, which is at most 45 degrees
  // here.
  EXPECT_GT(brightest_lid, 0.04F);
  EXPECT_LE(brightest_lid, 0.1F);
  EXPECT_GT(brightest_side, 0.4F);
  EXPECT_LE(brightest_side, 0.9F);

  folder.write("materials.yaml", "lead: 0.1\nglass: 0.9\n");
  EXPECT_THAT(scan(options).err,
              HasSubstr("no material glass; its materials are (none), lead, chalk"));
  folder.write("materials.yaml", "lead: 1.1\n");
  EXPECT_THAT(
      scan(options).err,
      HasSubstr("materials.yaml:1: material lead is '1.1'; it must be glass, mirror or a number"));
}

// The camera faces the side at x = 1 from x = 5 and then from x = 3. All depths there are 4 and 2
// m.
TEST_F(ScanCommand, WritesDepthImagesForCamera) {
  folder.write("camera.yaml",
               "name: Test camera\nkind: camera\nwidth_px: 20\nheight_px: 10\n"
               "horizontal_fov_deg: 10\nvertical_fov_deg: 5\n");
  folder.write("views.csv",
               "view,x,y,z,direction_x,direction_y,direction_z\n0,5,0,1,-1,0,0\n1,3,0,1,-1,0,0\n");
  const ProgramRun run = scan({"--route", folder.path(), "--sensor", folder / "camera.yaml",
                               "--set", "scan.depth_unit=0.002", "--set", "scan.speed=4"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("2 depth images"));
  EXPECT_THAT(files(), testing::ElementsAre("camera.json", "depth.txt", "depth_000000.png",
                                            "depth_000001.png", "estimated.txt", "groundtruth.txt",
                                            "preview.ply", "scan.html", "scan.json"));
  EXPECT_THAT(tests::read_content(folder / "out/depth.txt"),
              HasSubstr("0.000000 depth_000000.png\n0.500000 depth_000001.png\n"));
  EXPECT_THAT(geometry::read_depth_png(folder / "out/depth_000000.png").values,
              testing::Each(2000));
  const geometry::DepthImage near = geometry::read_depth_png(folder / "out/depth_000001.png");
  EXPECT_EQ(near.width, 20);
  EXPECT_EQ(near.height, 10);
  EXPECT_THAT(near.values, testing::Each(1000));
  const auto json = nlohmann::json::parse(tests::read_content(folder / "out/camera.json"));
  EXPECT_NEAR(json["focal_length_px"][0], 10 / std::tan(5 * 3.14159265 / 180), 1e-6);
  EXPECT_EQ(json["depth_unit_m"], 0.002);
}

// The dataset is equal with and without the requested rawlog.
TEST_F(ScanCommand, WritesRawlogForCameraOnRequest) {
  folder.write("views.csv",
               "view,x,y,z,direction_x,direction_y,direction_z\n0,5,0,1,-1,0,0\n1,3,0,1,-1,0,0\n");
  const ProgramRun run =
      scan({"--route", folder.path(), "--sensor", "see_d435", "--format", "rawlog"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(files(), testing::Contains("frames.rawlog"));
  // Two images of 848 x 480 pixels with 16 bits, plus metadata.
  EXPECT_GT(std::filesystem::file_size(folder / "out/frames.rawlog"), 2 * 2 * 848 * 480);
}

// EPSG 32630 is the UTM zone of Oxford. Its axes are rotated by 1.4 degrees and its scale differs
// by at most 0.03%. The cube therefore remains a 2 m cube to 0.1 m.
TEST_F(ScanCommand, WritesLasInMapCoordinatesOnRequest) {
  const std::vector<std::string> georeference = {"--set", "site.latitude_deg=51.7534",
                                                 "--set", "site.longitude_deg=-1.254",
                                                 "--set", "site.ellipsoid_height=110"};
  std::vector<std::string> options = {"--set", "scan.crs=utm", "--format", "las,xyz"};
  options.insert(options.end(), georeference.begin(), georeference.end());
  ASSERT_EQ(scan(options).exit_code, 0);
  const LasFile las(folder / "out/scan.las");
  EXPECT_THAT(las.crs, HasSubstr("AUTHORITY[\"EPSG\",\"32630\"]"));
  EXPECT_THAT(las.crs, HasSubstr("ellipsoid height"));
  EXPECT_EQ(summary()["las_crs"], "utm");
  // The other files of the mission remain in local coordinates.
  const auto local = geometry::read_cloud(folder / "out/scan.xyz").positions;
  EXPECT_LT(largest_error(local), 0.068F);
  ASSERT_EQ(las.points.size(), local.size());
  const flight::UtmProjection utm({{51.7534, -1.254, 110.0}, {}});
  for (std::size_t i = 0; i < local.size(); ++i) {
    const Eigen::Vector3d expected = utm.to_map(local[i].cast<double>());
    ASSERT_LT((las.points[i].position - expected).norm(), 2e-4);  // steps of 0.1 mm in both files
  }
  // `evaluate` requires local coordinates and reports an error otherwise.
  const ProgramRun evaluated = run_skycap({"evaluate", "--cloud", folder / "out/scan.las",
                                           "--model", folder / "cube.obj", "--distance", "0.1"});
  EXPECT_EQ(evaluated.exit_code, 2);
  EXPECT_THAT(evaluated.err, HasSubstr("scan.las: point 0 is 573"));
  EXPECT_THAT(evaluated.err, HasSubstr("coordinates must be local"));
}

// A second, rotated cube 6 m to the east is scanned and evaluated as well.
TEST_F(ScanCommand, ScansAndEvaluatesModelCopies) {
  const std::string both =
      folder.write("both.yaml",
                   "scene: {model: cube.obj, copies: [[6, 1, 45]]}\n"
                   "scan:\n"
                   "  sensor: laser.yaml\n"
                   "  orbit: {radius: 12, min_height: 1, circles: 1, speed: 100}\n"
                   "evaluation: {coverage_distance: 0.1}\n");
  const auto run = run_skycap({"scan", both, "--out", folder / "both", "--format", "xyz"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::size_t first = 0, second = 0;
  for (const Vector3f& point : geometry::read_cloud(folder / "both/scan.xyz").positions) {
    const Vector3f own = point - Vector3f(0, 0, 1);
    const Vector3f other =
        Eigen::AngleAxisf(-0.785398163F, Vector3f::UnitZ()) * (point - Vector3f(6, 1, 1));
    const float off_first = std::abs(own.cwiseAbs().maxCoeff() - 1.0F);
    const float off_second = std::abs(other.cwiseAbs().maxCoeff() - 1.0F);
    EXPECT_LT(std::min(off_first, off_second), 0.068F);  // range noise
    ++(off_first < off_second ? first : second);
  }
  EXPECT_GT(first, 500U);
  EXPECT_GT(second, 500U);

  // Points that cover a fraction of one cube cover half that fraction of two cubes.
  ASSERT_EQ(scan({"--format", "las"}).exit_code, 0);
  const auto coverage = [&](const std::string& of) {
    const ProgramRun evaluated =
        run_skycap({"evaluate", "--cloud", folder / "out/scan.las", "--model", of, "--json"});
    EXPECT_EQ(evaluated.exit_code, 0) << evaluated.err;
    return nlohmann::json::parse(evaluated.out)["coverage"].get<double>();
  };
  EXPECT_GT(coverage(mission), 0.2);
  EXPECT_NEAR(coverage(both), 0.5 * coverage(mission), 0.01);  // accuracy with 100,000 samples

  const auto model = run_skycap({"model", both, "--out", folder / "all.ply"});
  ASSERT_EQ(model.exit_code, 0) << model.err;
  const geometry::Mesh mesh = geometry::read_mesh(folder / "all.ply");
  EXPECT_EQ(mesh.triangles.size(), 24U);
  EXPECT_NEAR(geometry::bounding_box(mesh).max().x(), 6 + std::sqrt(2.0), 1e-6);
}

TEST_F(ScanCommand, KeepsFilesCompleteOnCtrlC) {
  std::stop_source stop;
  stop.request_stop();
  const ProgramRun run = scan({"--format", "ply"}, stop.get_token());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, HasSubstr("interrupted"));
  EXPECT_EQ(summary()["complete"], false);
  EXPECT_THAT(tests::read_content(folder / "out/scan.ply"), HasSubstr("element vertex 0\n"));
  EXPECT_THAT(run.err, HasSubstr("no report written after Ctrl-C; run skycap report to write it"));
}

TEST_F(ScanCommand, OmitsEmptyRawlog) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(scan({"--format", "rawlog,ply"}, stop.get_token()).exit_code, 1);
  EXPECT_THAT(files(), testing::Not(testing::Contains("scan.rawlog")));
  const auto written = summary();
  for (const auto& file : written["files"]) EXPECT_NE(file["name"], "scan.rawlog");
}

TEST_F(ScanCommand, RejectsWithOneLineAndNoOutput) {
  const auto rejected = [&](const std::vector<std::string>& options) {
    const ProgramRun run = scan(options);
    EXPECT_EQ(run.exit_code, 2) << run.out;
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1);
    EXPECT_THAT(files(), testing::IsEmpty());
    return run.err;
  };
  EXPECT_THAT(rejected({"--format", "zip"}),
              HasSubstr("unknown point format 'zip'; expected one of: las"));
  EXPECT_THAT(rejected({"--format", "las,las7"}),
              HasSubstr("two formats use the file name scan.las"));
  EXPECT_THAT(rejected({"--sensor", "sonar"}), HasSubstr("unknown sensor sonar"));
  EXPECT_THAT(rejected({"--route", folder / "none.tum"}), HasSubstr("none.tum"));
  EXPECT_THAT(rejected({"--set", "scan.orbit.radius=0"}), HasSubstr("key scan.orbit.radius"));
  EXPECT_THAT(rejected({"--set", "scan.crs=utm"}),
              HasSubstr("scan.crs: utm requires a georeference"));
  EXPECT_THAT(rejected({"--set", "scene.copies=[[6, 1]]"}), HasSubstr("key scene.copies"));
}

}  // namespace
}  // namespace skycap::missions
