// Scenes of tiles: the listed tiles, and results that do not depend on the tiles in memory.
#include "missions/scene/scene_tiles.h"

#include <cmath>
#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/mesh_io.h"
#include "missions/config/resolve.h"
#include "missions/scene/scene_source.h"
#include "tests/missions/cli/cube_scan.h"
#include "tests/sim/shapes.h"

namespace skycap::missions {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::run_skycap;

/// Four spheres in a row, 30 m apart, one in each tile. A scanner with a range of 50 m flies 100 m
/// along them.
class TileScan : public tests::CubeScan {
 protected:
  TileScan() {
    for (const int i : {0, 1, 2, 3}) {
      const geometry::Mesh tile = sim::sphere({30.0 * i, 10.0, 5.0 + i}, 4.0, 3);
      geometry::write_mesh(folder_.path() / ("tile_" + std::to_string(i) + ".ply"), tile);
      geometry::append(joined_, tile);
    }
    geometry::write_mesh(folder_.path() / "joined.ply", joined_);
    folder_.write("flight.tum", "0 -10 0 8 0 0 0 1\n1 90 0 8 0 0 0.70710678 0.70710678\n");
    write_tiles("[{files: 'tile_?.ply'}]");
  }

  void write_mission(const std::string& model, const std::string& more = "") const {
    folder_.write("m.yaml", "scene: {model: '" + model + "'" + more +
                                "}\nscan: {sensor: laser.yaml, route: flight.tum}\n"
                                "evaluation: {coverage_distance: 0.1}\n");
  }
  void write_tiles(const std::string& tiles) const {
    folder_.write("scene.tiles", "tiles: " + tiles + "\n");
    write_mission("scene.tiles");
  }
  config::MissionSetup mission() const { return config::read_mission(folder_ / "m.yaml"); }

  std::string rejection() const {
    const auto run = run_skycap(scan("part", {}));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    return run.err;
  }

  geometry::Mesh joined_;
};

// A process that measures a shard has other tiles in memory than one that measures the whole
// flight.
TEST_F(TileScan, WritesSameBytesForAnyNumberOfPieces) {
  ASSERT_EQ(run_skycap(scan("whole", clouds_)).exit_code, 0);
  for (const char* const tile_count : {"2", "4", "9"}) {
    const auto run = run_skycap(scan("part", with(clouds_, {"--pieces", tile_count})));
    ASSERT_EQ(run.exit_code, 0) << run.err;
    expect_same_results();
    std::filesystem::remove_all(folder_ / "part");
  }
}

// Reference: the same triangles in one mesh.
TEST_F(TileScan, MatchesScanOfJoinedMesh) {
  ASSERT_EQ(run_skycap(scan("part", {"--format", "xyz"})).exit_code, 0);
  write_mission("joined.ply", ", position: [45, 10, 1]");
  ASSERT_EQ(run_skycap(scan("whole", {"--format", "xyz"})).exit_code, 0);
  const auto read_numbers = [&](const std::string& name) {
    std::istringstream text(tests::read_content(folder_ / name));
    std::string line;
    std::getline(text, line);
    std::vector<double> numbers;
    for (double number = 0.0; text >> number;) numbers.push_back(number);
    return numbers;
  };
  const std::vector<double> tiles = read_numbers("part/scan.xyz"),
                            one = read_numbers("whole/scan.xyz");
  EXPECT_GT(one.size(), 8U * 500);
  ASSERT_EQ(tiles.size(), one.size());
  // Rounding moves a ray by about 1e-5 m, and a grazing hit by more.
  std::size_t different = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    different += std::abs(tiles[i] - one[i]) > 2e-3 ? 1 : 0;
  }
  EXPECT_LE(different, one.size() / 1000);
}

// Property: within the range, rays hit bitwise identical points, independent of other tiles.
TEST_F(TileScan, HitsSamePointsForAnyLoadedDistantTiles) {
  const scene::TiledScene tiles(mission().scene(), folder_.path(), 0);
  EXPECT_EQ(tiles.triangles(), joined_.triangles.size());
  std::vector<AlignedBox3d> boxes;
  const sim::Scene all = tiles.scene(1, [&](const AlignedBox3d& box) {
    boxes.push_back(box);
    return true;
  });
  ASSERT_EQ(boxes.size(), 4U);
  const sim::Scene two =
      tiles.scene(1, [&](const AlignedBox3d& box) { return box.center().x() > 40.0; });
  const sim::Scene none = tiles.scene(1, [](const AlignedBox3d&) { return false; });
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const double z = normal(random), y = normal(random), x = normal(random);
    const Vector3d origin(75.0, 10.0, 20.0);
    const Vector3d direction = Vector3d(x, y, -std::abs(z)).normalized();
    const auto hit = all.first_hit(origin, direction, 40.0);
    const auto again = two.first_hit(origin, direction, 40.0);
    EXPECT_FALSE(none.first_hit(origin, direction, 40.0));
    ASSERT_EQ(hit.has_value(), again.has_value());
    if (!hit) continue;
    ++hits;
    EXPECT_EQ(hit->distance, again->distance);
    EXPECT_EQ(hit->normal, again->normal);
  }
  EXPECT_GT(hits, 50);
}

TEST_F(TileScan, JoinsTilesIntoOneMesh) {
  const geometry::Mesh mesh = scene::load_model(mission().scene(), folder_.path());
  EXPECT_EQ(mesh.triangles.size(), joined_.triangles.size());
  const AlignedBox3d box = geometry::bounding_box(mesh), expected = geometry::bounding_box(joined_);
  EXPECT_LT((box.min() - expected.min()).norm(), 1e-5);
  EXPECT_LT((box.max() - expected.max()).norm(), 1e-5);
}

TEST_F(TileScan, ArrangesTilesInRowsAndColumns) {
  write_tiles(
      "[{model: 'builtin:city-block', columns: 3, rows: 2, spacing: 250, kinds: 0, seed: 7}]");
  const auto tiles = scene::find_tiles(mission().scene(), folder_.path());
  ASSERT_EQ(tiles.size(), 6U);
  std::set<std::uint64_t> seeds;
  Vector3d sum = Vector3d::Zero();
  for (const auto& tile : tiles) {
    seeds.insert(tile.scene.seed);
    ASSERT_EQ(tile.shifts.size(), 1U);
    sum += tile.shifts[0];
  }
  EXPECT_THAT(seeds, ElementsAre(7, 8, 9, 10, 11, 12));
  EXPECT_EQ(sum.norm(), 0.0);
  EXPECT_EQ(tiles[0].shifts[0], Vector3d(-250, -125, 0));
  EXPECT_EQ(tiles[5].shifts[0], Vector3d(250, 125, 0));

  write_tiles("[{model: 'builtin:city-block', columns: 9, rows: 9, spacing: 250, kinds: 2}]");
  const auto few = scene::find_tiles(mission().scene(), folder_.path());
  ASSERT_EQ(few.size(), 2U);
  EXPECT_EQ(few[0].shifts.size() + few[1].shifts.size(), 81U);
}

TEST_F(TileScan, RejectsInvalidTilesInOneLine) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"[{files: 'nothing*.ply'}]", "files is nothing*.ply and matches no file"},
      {"[{files: 'tile_?.ply', model: joined.ply}]", "conflicts with model or is missing"},
      {"[{model: joined.ply, rows: 2}]", "spacing"},
      {"[{model: joined.ply, rows: 2, spacing: -1}]", "spacing must be above 0"},
      {"[{model: joined.ply, rows: 0}]", "rows must be from 1 to 10000"},
      {"[{model: joined.ply, rows: 9999, columns: 9999, spacing: 9}]",
       "rows: multiplied by columns must be at most 1000000"},
      {"[{model: joined.ply, kinds: 3}]", "applies only to generated builtin models"},
      {"[{model: joined.ply, position: [1, 2]}]", "position must be [east, north, up]"},
      {"[{model: joined.ply, colour: red}]", "colour"},
      {"[{model: scene.tiles}]", "model is itself a tile list"},
      {"[]", "tiles is missing"}};
  for (const auto& [tiles, message] : wrong) {
    write_tiles(tiles);
    EXPECT_THAT(rejection(), AllOf(HasSubstr("scene.tiles"), HasSubstr(message)));
  }
  write_tiles("[{files: 'tile_?.ply'}]");
  write_mission("scene.tiles", ", copies: [[0, 100, 0]]");
  EXPECT_THAT(rejection(), HasSubstr("scene.copies conflicts with a tile list"));
  write_mission("scene.tiles");
  folder_.write("tile_4.ply", "ply\n");
  EXPECT_THAT(rejection(), HasSubstr("tile_4.ply"));
}

}  // namespace
}  // namespace skycap::missions
