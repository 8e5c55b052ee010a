#include <filesystem>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/io/column_cloud.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using tests::ProgramRun;
using tests::run_skycap;

/// Box of 8 m x 12 m x 6 m in UTM coordinates. `grown` moves the northern half of the wall in
/// the east outwards, and `share` is the fraction of the length in y that is measured.
geometry::ColumnCloud make_house(std::uint64_t seed, double grown, double share,
                                 const Vector3d& shift = Vector3d::Zero()) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, 0.01);
  geometry::ColumnCloud cloud;
  for (int i = 0; i < 60000; ++i) {
    Vector3d point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = place(random);
    const int side = i % 5, axis = side / 2;
    point[axis] = side % 2 == 0 ? 1.0 : -1.0;
    if (point.y() > 2.0 * share - 1.0) continue;
    point = point.cwiseProduct(Vector3d(4.0, 6.0, 3.0));
    point[axis] += normal(random);
    if (side == 0 && point.y() > 0.0) point.x() += grown;
    cloud.positions.push_back(point + shift + Vector3d(412'000.0, 5'655'000.0, 300.0));
  }
  return cloud;
}

class EvaluateChange : public testing::Test {
 protected:
  std::string write(const std::string& name, const geometry::ColumnCloud& cloud) const {
    geometry::write_column_cloud(folder / name, cloud);
    return folder / name;
  }
  nlohmann::json evaluate(const std::string& cloud,
                          const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"evaluate", "--cloud", cloud,        "--reference",
                                          reference,  "--json",  "--cylinder", "0.5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun run = run_skycap(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out);
  }

  tests::TestFolder folder;
  const std::string reference = write("reference.laz", make_house(1, 0.0, 1.0));
};

TEST_F(EvaluateChange, MeasuresGrownWall) {
  const std::string cloud = write("cloud.ply", make_house(2, 0.1, 1.0));
  const nlohmann::json json = evaluate(cloud, {"--out", folder / "change"});
  EXPECT_EQ(json["alignment"]["aligned"], true);
  const geometry::ColumnCloud cores = geometry::read_column_cloud(folder / "change/change.ply");
  EXPECT_EQ(json["core_points"], cores.positions.size());
  // Half of the wall in the east has 36 of 348 m^2; distances elsewhere are within the noise.
  EXPECT_GT(json["significant"], 0.09);
  EXPECT_LT(json["significant"], 0.25);
  EXPECT_NEAR(json["distance_m"]["percentile_95"].get<double>(), 0.1, 0.01);
  EXPECT_NEAR(json["distance_m"]["median"].get<double>(), 0.0, 0.002);
  EXPECT_GT(json["completeness_of_reference"], 0.99);
  for (const char* const file : {"change.json", "change.html", "change.png"}) {
    EXPECT_TRUE(std::filesystem::file_size(folder / ("change/" + std::string(file))) > 500U);
  }
}

TEST_F(EvaluateChange, MeasuresCompletenessBothWays) {
  const nlohmann::json json = evaluate(write("half.ply", make_house(2, 0.0, 0.6)));
  EXPECT_NEAR(json["completeness_of_reference"].get<double>(), 0.6, 0.08);
  EXPECT_GT(json["completeness_of_cloud"], 0.99);
}

TEST_F(EvaluateChange, ReportsOrRemovesOffset) {
  const Vector3d shift(0.3, -0.2, 0.1);
  const std::string cloud = write("moved.e57", make_house(2, 0.0, 1.0, shift));
  const nlohmann::json json = evaluate(cloud);
  EXPECT_EQ(json["alignment"]["aligned"], false);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(json["alignment"]["offset_m"][static_cast<std::size_t>(axis)].get<double>(),
                shift[axis], 0.005);
  }
  EXPECT_GT(json["significant"], 0.5);
  const ProgramRun text =
      run_skycap({"evaluate", "--cloud", cloud, "--reference", reference, "--cylinder", "0.5"});
  EXPECT_THAT(text.out, HasSubstr("NOT aligned; offset 0.3"));
  const nlohmann::json aligned = evaluate(cloud, {"--align", "--registration-error", "0.002"});
  EXPECT_EQ(aligned["alignment"]["applied"], true);
  EXPECT_LT(aligned["significant"], 0.1);
  EXPECT_NEAR(aligned["distance_m"]["median"].get<double>(), 0.0, 0.002);
}

TEST_F(EvaluateChange, RejectsConflictsAndFarClouds) {
  const auto rejected = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "evaluate");
    const ProgramRun run = run_skycap(arguments);
    EXPECT_NE(run.exit_code, 0);
    return run.err;
  };
  EXPECT_THAT(rejected({"--cloud", reference}), HasSubstr("--reference"));
  EXPECT_THAT(rejected({"--mesh", reference, "--reference", reference}),
              HasSubstr("--reference requires --cloud"));
  EXPECT_THAT(rejected({"--cloud", reference, "--reference", reference, "--pieces", "2"}),
              HasSubstr("--reference requires --cloud"));
  const std::string far = write("far.ply", make_house(2, 0.0, 1.0, Vector3d(50'000.0, 0.0, 0.0)));
  EXPECT_THAT(rejected({"--cloud", far, "--reference", reference}), HasSubstr("check the coord"));
}

}  // namespace
}  // namespace skycap::missions
