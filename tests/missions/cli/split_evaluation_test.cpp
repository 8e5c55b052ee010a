// An evaluation in shards gives the same results as that of the whole cloud.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/io/cloud_io.h"
#include "geometry/io/mesh_io.h"
#include "tests/missions/run_skycap.h"
#include "tests/sim/shapes.h"

namespace skycap::missions {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tests::run_skycap;

/// Points close to half a sphere with a radius of 2 m.
class SplitEvaluation : public testing::Test {
 protected:
  SplitEvaluation() {
    geometry::write_mesh(folder_.path() / "sphere.ply", sim::sphere({0, 0, 2}, 2.0, 3));
  }

  void write_cloud(std::size_t count) const {
    std::mt19937_64 random(1);
    std::normal_distribution<float> normal;
    std::vector<Eigen::Vector3f> points;
    while (points.size() < count) {
      const float noise = normal(random), z = normal(random), y = normal(random),
                  x = std::abs(normal(random));
      const float radius = 2.0F + 0.01F * noise;
      points.emplace_back(Eigen::Vector3f(0, 0, 2) +
                          radius * Eigen::Vector3f(x, y, z).normalized());
    }
    geometry::write_cloud(folder_.path() / "cloud.ply",
                          {.positions = points, .normals = {}, .views = {}, .colours = {}});
  }

  tests::ProgramRun evaluate(const std::vector<std::string>& more) const {
    std::vector<std::string> words{
        "evaluate",   "--cloud", folder_ / "cloud.ply", "--model", folder_ / "sphere.ply", "--json",
        "--distance", "0.05",    "--samples",           "2000"};
    words.insert(words.end(), more.begin(), more.end());
    return run_skycap(words);
  }
  tests::ProgramRun shards(std::size_t count, const std::vector<std::string>& more) const {
    std::vector<std::string> words{"--out", folder_ / "out", "--pieces", std::to_string(count)};
    words.insert(words.end(), more.begin(), more.end());
    return evaluate(words);
  }

  tests::TestFolder folder_;
};

TEST_F(SplitEvaluation, MatchesUnsplitEvaluationExactly) {
  write_cloud(1'100'000);  // readers return chunks of up to a million points
  const std::string whole = evaluate({}).out;
  const auto figures = nlohmann::json::parse(whole);
  EXPECT_EQ(figures.at("points"), 1'100'000);
  EXPECT_NEAR(figures.at("coverage").get<double>(), 0.5, 0.03);  // half of the sphere
  for (const std::size_t count : {1, 2, 4}) {
    for (std::size_t i = count; i-- > 0;) {
      const auto run = shards(count, {"--index", std::to_string(i), "--threads", "1"});
      ASSERT_EQ(run.exit_code, 0) << run.err;
      EXPECT_EQ(run.out, "");
    }
    const auto run = shards(count, {"--collect"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.out, whole);
    EXPECT_THAT(tests::read_content(folder_ / "out/evaluation.json"),
                HasSubstr("\"complete\": true"));
    EXPECT_FALSE(fs::exists(folder_ / "out/pieces"));
    fs::remove_all(folder_ / "out");
  }
}

// In missions with ground the scanner also measures the ground, which is not an error of the
// model's points.
TEST_F(SplitEvaluation, SeparatesGroundFromModel) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 500; ++i) {
    const float angle = 0.01F * static_cast<float>(i);
    points.push_back({2.01F * std::cos(angle), 2.01F * std::sin(angle), 2.0F});
    points.push_back({5.0F * std::cos(angle), 5.0F * std::sin(angle), 0.01F});
  }
  geometry::write_cloud(folder_.path() / "cloud.ply",
                        {.positions = points, .normals = {}, .views = {}, .colours = {}});
  folder_.write("m.yaml",
                "scene: {model: sphere.ply, ground: true}\n"
                "planner: {view_distance: 5, density: 100, resolution_radius: 0.5, scene_box: "
                "{min: [-3, -3, 0.1], max: [3, 3, 5]}}\n"
                "evaluation: {coverage_distance: 0.1, visible_directions: 20}\n");
  const std::vector<std::string> words{"evaluate", "--cloud", folder_ / "cloud.ply", "--model",
                                       folder_ / "m.yaml"};
  const auto run_evaluate = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    const auto run = run_skycap(all);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.out;
  };
  const std::string whole = run_evaluate({"--json"});
  const auto figures = nlohmann::json::parse(whole);
  EXPECT_EQ(figures.at("points"), 500);
  EXPECT_EQ(figures.at("points_beside"), 500);
  EXPECT_NEAR(figures.at("distance_to_model_m").at("mean").get<double>(), 0.01, 0.02);
  EXPECT_THAT(run_evaluate({}), HasSubstr("500 further points lie on the ground"));
  EXPECT_EQ(run_evaluate({"--json", "--out", folder_ / "out", "--pieces", "2"}), whole);
}

TEST_F(SplitEvaluation, SkipsCompletePiecesAndReportsMissingOnes) {
  write_cloud(1000);
  ASSERT_EQ(shards(2, {"--index", "1"}).exit_code, 0);
  const fs::path shard = folder_.path() / "out" / "pieces" / "1_of_2" / "piece.json";
  const auto written = fs::last_write_time(shard);
  ASSERT_EQ(shards(2, {"--index", "1"}).exit_code, 0);
  EXPECT_EQ(fs::last_write_time(shard), written);
  const auto early = shards(2, {"--collect"});
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_THAT(early.err, HasSubstr("1 of 2 pieces are complete; missing 0"));
  // This shard exists twice.
  ASSERT_EQ(shards(2, {"--index", "1", "--distance", "0.06"}).exit_code, 2);
  ASSERT_EQ(shards(2, {"--index", "0"}).exit_code, 0);
  fs::resize_file(folder_.path() / "out" / "pieces" / "0_of_2" / "distances.bin", 4);
  const auto damaged = shards(2, {"--collect"});
  EXPECT_EQ(damaged.exit_code, 2);
  EXPECT_THAT(damaged.err, HasSubstr("distances.bin: is truncated"));
}

TEST_F(SplitEvaluation, RejectsPiecesWithOtherNumbers) {
  write_cloud(1000);
  ASSERT_EQ(shards(2, {"--index", "0"}).exit_code, 0);
  ASSERT_EQ(shards(2, {"--index", "1"}).exit_code, 0);
  const fs::path file = folder_.path() / "out" / "pieces" / "1_of_2" / "piece.json";
  std::ifstream stream(file);
  const auto whole = nlohmann::ordered_json::parse(stream);
  const auto collected = [&](const char* field, const nlohmann::ordered_json& value) {
    auto changed = whole;
    changed[field] = value;
    std::ofstream(file) << changed;
    const auto run = shards(2, {"--collect"});
    EXPECT_EQ(run.exit_code, 2) << field;
    return run.err;
  };
  EXPECT_THAT(collected("points", 1'000'000'000'000), HasSubstr("distances.bin: is truncated"));
  EXPECT_THAT(collected("covered", "01"), HasSubstr("piece.json: is damaged"));
}

TEST_F(SplitEvaluation, RejectsUnsupportedInput) {
  const auto rejection = [&](const std::vector<std::string>& words) {
    const auto run = run_skycap(words);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    return run.err;
  };
  const std::string model = folder_ / "sphere.ply", out = folder_ / "out";
  EXPECT_THAT(rejection({"evaluate", "--mesh", model, "--model", model, "--distance", "0.1",
                         "--pieces", "2", "--out", out}),
              HasSubstr("--pieces requires --cloud and --out"));
  EXPECT_THAT(
      rejection({"evaluate", "--cloud", model, "--model", model, "--distance", "0.1", "--collect"}),
      HasSubstr("require --pieces"));
  EXPECT_THAT(rejection({"evaluate", "--cloud", folder_ / "none.las", "--model", model,
                         "--distance", "0.1", "--pieces", "2", "--out", out}),
              HasSubstr("none.las: does not exist"));
}

}  // namespace
}  // namespace skycap::missions
