// LAS files of real surveys: old versions, classes, feet, many points.

#include <fstream>

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
using testing_support::make_las;
using testing_support::make_source;
using testing_support::site_at_cube;

class Las : public testing::Test {
 protected:
  Prior read(const std::string& bytes, const std::function<void(Source&)>& change = {}) {
    Source source = make_source(folder_.file("scan.las", bytes));
    if (change) change(source);
    return read_prior(source, site_at_cube());
  }
  const Cube cube_{};
  testing_support::TemporaryFolder folder_;
};

TEST_F(Las, KeepsSelectedClasses) {
  for (const auto& [minor, format] : {std::pair(2, 3), {4, 6}}) {
    const std::string bytes = make_las(cube_, minor, format);
    EXPECT_EQ(read(bytes, [](Source& s) { s.select.classes = {6}; }).points.size(), 4U);
    EXPECT_EQ(read(bytes, [](Source& s) { s.select.classes = {2, 6}; }).points.size(), 8U);
    EXPECT_THAT([&] { read(bytes, [](Source& s) { s.select.classes = {9}; }); },
                ThrowsMessage<Error>(HasSubstr("contains neither surfaces nor points")));
  }
}

TEST_F(Las, IsRejectedAsTerrainTargetOrGroundTruth) {
  for (const Role role : {Role::terrain, Role::target, Role::truth}) {
    EXPECT_THAT(
        [&] { read(make_las(cube_, 4, 6), [&](Source& s) { s.role = role; }); },
        ThrowsMessage<Error>(testing::AnyOf(HasSubstr("scan.las: contains no object surfaces"),
                                            HasSubstr("scan.las: is a point cloud"))));
  }
}

TEST_F(Las, KeepsOnePointPerVoxel) {
  EXPECT_EQ(read(make_las(cube_, 4, 6), [](Source& s) { s.spacing = 1e4; }).points.size(), 1U);
  EXPECT_EQ(read(make_las(cube_, 4, 6), [](Source& s) { s.spacing = 0.1; }).points.size(), 8U);
}

TEST_F(Las, ReadsReferenceSystemFromRecord) {
  const std::string wkt =
      "PROJCS[\"ETRS89 / UTM zone 32N\",GEOGCS[\"ETRS89\",DATUM[\"European_Terrestrial_Reference_"
      "System_1989\",SPHEROID[\"GRS 1980\",6378137,298.257222101]],PRIMEM[\"Greenwich\",0],UNIT["
      "\"degree\",0.0174532925199433],AUTHORITY[\"EPSG\",\"4258\"]],PROJECTION[\"Transverse_"
      "Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",9],"
      "PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],PARAMETER["
      "\"false_northing\",0],UNIT[\"metre\",1],AUTHORITY[\"EPSG\",\"25832\"]]";
  const Prior by_record = read(make_las(cube_, 4, 6, wkt), [](Source& s) { s.crs.clear(); });
  const Prior by_key = read(make_las(cube_, 4, 6));
  EXPECT_EQ(by_record.crs, "ETRS89 / UTM zone 32N");
  EXPECT_LT((by_record.points[7] - by_key.points[7]).norm(), 1e-4F);
}

TEST_F(Las, KeepsPositionsOfSkycapScans) {
  Cube near;
  near.low = {1.0, 2.0, 3.0};
  const Prior prior = read(
      make_las(near, 4, 6, "LOCAL_CS[\"local east-north-up\",LOCAL_DATUM[\"mission origin\",0]]"),
      [](Source& s) {
        s.crs.clear();
        s.vertical.reset();
      });
  EXPECT_TRUE(prior.points[0].isApprox(Eigen::Vector3f(1, 2, 3)));
}

// The file is read in chunks, independent of its size. Most of it is a sparse hole.
TEST_F(Las, ReadsFilesLargerThanTwoGigabytes) {
  const std::filesystem::path file = folder_.file("large.las", make_las(cube_, 2, 3));
  std::filesystem::resize_file(file, max_bytes + (std::size_t{1} << 20));
  EXPECT_EQ(read_prior(make_source(file), site_at_cube()).points.size(), 8U);
}

TEST_F(Las, RejectsMissingCompressionRecord) {
  std::string bytes = make_las(cube_, 2, 3);
  bytes[104] = static_cast<char>(0x83);
  EXPECT_THAT([&] { read(bytes); }, ThrowsMessage<Error>(HasSubstr("the LAZ record is missing")));
}

/// Airborne scan of Autzen Stadium from the shared models: Oregon Lambert in feet, heights in feet.
TEST_F(Las, ReadsAirborneScanInFeet) {
  const char* const models = std::getenv("SKYCAP_MODELS");  // NOLINT(concurrency-mt-unsafe)
  const std::filesystem::path file =
      std::filesystem::path(models == nullptr ? "" : models) / "recorded/autzen_trim.las";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "autzen_trim.las is not there";
  Source source;
  source.file = file;
  source.vertical = HeightDatum::ellipsoid;
  source.spacing = 1e-3;
  const flight::GeodeticPoint stadium{44.0583, -123.0684, 120.0};
  const Prior prior = read_prior(source, {.origin = stadium});
  EXPECT_EQ(prior.points.size(), 110'000U);
  // The header states a box of 1177.46 ft by 562.7 ft with heights from 406.26 to 520.51 ft.
  EXPECT_NEAR(prior.box.sizes().x(), 1177.46 * 0.3048, 12.0);
  EXPECT_NEAR(prior.ellipsoid_heights->min, 406.26 * 0.3048, 1e-2);
  EXPECT_NEAR(prior.ellipsoid_heights->max, 520.51 * 0.3048, 1e-2);
}

}  // namespace
}  // namespace skycap::missions::site_data
