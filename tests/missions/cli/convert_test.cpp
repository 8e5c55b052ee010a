#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/io/column_cloud.h"
#include "geometry/io/las/las_reader.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using tests::ProgramRun;
using tests::run_skycap;

class Convert : public testing::Test {
 protected:
  ProgramRun convert(const std::string& in, const std::string& out,
                     const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"convert", folder / in, folder / out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_skycap(arguments);
  }

  std::size_t file_count() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder.path()), {}));
  }

  tests::TestFolder folder;
  const std::string text = folder.write(
      "a.xyz", "x y z intensity time nx ny nz\n1 2 3 4 5.5 0 0 1\n10.25 2 3 65535 6.5 0 1 0\n");
};

TEST_F(Convert, KeepsAttributesThroughAllFormats) {
  const std::vector<std::string> chain = {"a.xyz", "b.ply", "c.pcd", "d.e57", "e.csv"};
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const ProgramRun run = convert(chain[i - 1], chain[i]);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err, "");
  }
  const geometry::ColumnCloud cloud = geometry::read_column_cloud(folder / "e.csv");
  ASSERT_EQ(cloud.positions.size(), 2U);
  EXPECT_EQ(cloud.positions[1], Eigen::Vector3d(10.25, 2.0, 3.0));
  EXPECT_THAT(cloud.times, testing::ElementsAre(5.5, 6.5));
  EXPECT_THAT(cloud.column(geometry::CloudColumn::intensity), testing::ElementsAre(4.0F, 65535.0F));
  EXPECT_THAT(cloud.column(geometry::CloudColumn::normal_y), testing::ElementsAre(0.0F, 1.0F));
}

TEST_F(Convert, StatesInOneLineWhatIsNotKept) {
  const ProgramRun run = convert("a.xyz", "b.laz");
  ASSERT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("warning: " + folder / "b.laz: normals are not kept"));
  EXPECT_EQ(std::ranges::count(run.err, '\n'), 1);
}

TEST_F(Convert, ShiftsAndSetsReferenceSystem) {
  folder.write("utm.prj", "PROJCS[\"WGS 84 / UTM zone 30N\"]\n");
  ASSERT_EQ(convert("a.xyz", "b.laz",
                    {"--shift", "400000", "5700000", "-0.5", "--crs", folder / "utm.prj"})
                .exit_code,
            0);
  // Both ways of LAS files: with all fields, and through columns.
  ASSERT_EQ(convert("b.laz", "c.las", {"--shift", "1000", "0", "0"}).exit_code, 0);
  for (const auto& [name, x] : {std::pair("b.laz", 400001.0), {"c.las", 401001.0}}) {
    const geometry::ColumnCloud cloud = geometry::read_column_cloud(folder / name);
    EXPECT_LT((cloud.positions[0] - Eigen::Vector3d(x, 5700002.0, 2.5)).norm(), 1e-6);
    EXPECT_EQ(cloud.crs_wkt, "PROJCS[\"WGS 84 / UTM zone 30N\"]");
  }
  ASSERT_EQ(convert("c.las", "d.e57").exit_code, 0);
  EXPECT_EQ(geometry::read_column_cloud(folder / "d.e57").crs_wkt,
            "PROJCS[\"WGS 84 / UTM zone 30N\"]");
}

TEST_F(Convert, RejectsWithOneLineAndNoOutput) {
  folder.write("broken.laz", "LASF and nothing else");
  folder.write("far.xyz", "0 0 0\n1e20 0 0\n");
  folder.write("nan.ply", "ply\nformat ascii 1.0\nelement vertex x\n");
  const std::size_t files = file_count();
  const auto rejected = [&](const std::string& in, const std::string& out) {
    const ProgramRun run = convert(in, out);
    EXPECT_NE(run.exit_code, 0) << run.out;
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    EXPECT_EQ(file_count(), files);
    return run.err;
  };
  EXPECT_THAT(rejected("a.xyz", "a.xyz"), HasSubstr("are the same file"));
  EXPECT_THAT(rejected("a.xyz", "b.zip"), HasSubstr("must end in .ply"));
  EXPECT_THAT(rejected("a.xyz", "b.laz.gz"), HasSubstr("must end in .ply"));
  EXPECT_THAT(rejected("none.xyz", "b.laz"), HasSubstr("none.xyz"));
  EXPECT_THAT(rejected("broken.laz", "b.laz"), HasSubstr("broken.laz"));
  EXPECT_THAT(rejected("broken.laz", "b.ply"), HasSubstr("broken.laz"));
  EXPECT_THAT(rejected("nan.ply", "b.laz"), HasSubstr("nan.ply"));
  EXPECT_THAT(rejected("far.xyz", "b.laz"),
              HasSubstr("error: " + folder / "b.laz: coordinates extend over 1e+20 m"));
  EXPECT_THAT(convert("a.xyz", "b.laz", {"--crs", text}).err,
              HasSubstr("is not a reference system in WKT"));
  EXPECT_EQ(file_count(), files);
}

TEST_F(Convert, EndsOnStopRequestWithoutOutput) {
  std::stop_source stop;
  stop.request_stop();
  const std::size_t files = file_count();
  const ProgramRun run = run_skycap({"convert", text, folder / "b.laz"}, false, stop.get_token());
  EXPECT_NE(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("interrupted"));
  EXPECT_EQ(file_count(), files);
}

}  // namespace
}  // namespace skycap::missions
