// E57 files as prior data: their own georeference, and files of any size.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/site_data/formats/file_contents.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;
using testing_support::Cube;
using testing_support::make_e57;
using testing_support::make_source;
using testing_support::site_at_cube;

class E57File : public testing::Test {
 protected:
  Prior read(const std::string& bytes, const std::function<void(Source&)>& change = {}) {
    Source source = make_source(folder_.file("scan.e57", bytes));
    if (change) change(source);
    return read_prior(source, site_at_cube());
  }
  const Cube cube_{};
  testing_support::TemporaryFolder folder_;
};

TEST_F(E57File, ReadsReferenceSystemFromMetadata) {
  const Prior by_file = read(make_e57(cube_, "EPSG:25832"), [](Source& s) { s.crs.clear(); });
  const Prior by_key = read(make_e57(cube_));
  EXPECT_EQ(by_file.crs, "ETRS89 / UTM zone 32N");
  EXPECT_EQ(by_file.points, by_key.points);
  EXPECT_THAT([&] { read(make_e57(cube_, "my garden"), [](Source& s) { s.crs.clear(); }); },
              ThrowsMessage<Error>(HasSubstr("scan.e57: ")));
}

TEST_F(E57File, KeepsPositionsOfSkycapScans) {
  Cube near;
  near.low = {1.0, 2.0, 3.0};
  const auto without_words = [](Source& s) {
    s.crs.clear();
    s.vertical.reset();
  };
  for (const char* words : {"", "LOCAL_CS[\"local east-north-up\",LOCAL_DATUM[\"origin\",0]]"}) {
    const Prior prior = read(make_e57(near, words), without_words);
    EXPECT_TRUE(prior.points[0].isApprox(Eigen::Vector3f(1, 2, 3)));
    EXPECT_TRUE(prior.points[7].isApprox(Eigen::Vector3f(11, 12, 13)));
    // If a file contains no reference system, a note states the assumption.
    EXPECT_EQ(prior.notes.empty(), *words != '\0');
  }
}

TEST_F(E57File, IsRejectedAsTerrainTargetOrGroundTruth) {
  for (const Role role : {Role::terrain, Role::target, Role::truth}) {
    EXPECT_THAT(
        [&] { read(make_e57(cube_), [&](Source& s) { s.role = role; }); },
        ThrowsMessage<Error>(testing::AnyOf(HasSubstr("scan.e57: contains no object surfaces"),
                                            HasSubstr("scan.e57: is a point cloud"))));
  }
}

TEST_F(E57File, KeepsOnePointPerVoxel) {
  EXPECT_EQ(read(make_e57(cube_), [](Source& s) { s.spacing = 1e4; }).points.size(), 1U);
  EXPECT_EQ(read(make_e57(cube_), [](Source& s) { s.spacing = 0.1; }).points.size(), 8U);
}

// The file is read in chunks, independent of its size. The part after the valid data is a sparse
// hole.
TEST_F(E57File, ReadsFilesLargerThanTwoGigabytes) {
  const std::filesystem::path file = folder_.file("large.e57", make_e57(cube_));
  std::filesystem::resize_file(file, max_bytes + (std::size_t{1} << 20));
  EXPECT_EQ(read_prior(make_source(file), site_at_cube()).points.size(), 8U);
}

TEST_F(E57File, RejectsClassSelection) {
  EXPECT_THAT([&] { read(make_e57(cube_), [](Source& s) { s.select.classes = {2}; }); },
              ThrowsMessage<Error>(HasSubstr("select.classes does not apply")));
}

}  // namespace
}  // namespace skycap::missions::site_data
