// Images of the site as backgrounds.
#include "missions/site_data/site_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/missions/site_data/gdal_files.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;
using testing::StartsWith;
using testing_support::thrown_message;
using testing_support::WrittenImage;

/// Position of the centre of the image, 500005 5315995 in EPSG:25832.
const SiteFrame site{.origin = flight::GeodeticPoint{47.997254, 9.000067, 500.0}};

class SiteImages : public testing::Test {
 protected:
  SiteImage read(const Eigen::AlignedBox2d& box, const WrittenImage& image = {}) const {
    const std::filesystem::path file = folder_.path() / "ortho.tif";
    testing_support::write_image(file, image);
    return read_site_image(file, site, box);
  }
  testing_support::TemporaryFolder folder_;
};

Eigen::AlignedBox2d square(double half) { return {Vector2d(-half, -half), Vector2d(half, half)}; }

/// Checks the corners of a square around the origin, to a pixel.
void expect_square(const SiteImage& image, double half) {
  constexpr double pixel = 1.1;
  const std::array<Vector2d, 4> corners{Vector2d(-half, half), Vector2d(half, half),
                                        Vector2d(half, -half), Vector2d(-half, -half)};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_LT((image.corners[i] - corners[i]).cwiseAbs().maxCoeff(), pixel) << i;
  }
}

TEST_F(SiteImages, CoverTheBox) {
  const SiteImage image = read(square(20));
  expect_square(image, 20);
  EXPECT_EQ(image.name, "ortho.tif");
  EXPECT_THAT(image.jpeg, StartsWith("\xFF\xD8\xFF"));
}

TEST_F(SiteImages, EndAtTheBorderOfTheFile) { expect_square(read(square(500)), 50); }

TEST_F(SiteImages, AreReadFromGreyImages) {
  EXPECT_THAT(read(square(20), {.bands = 1}).jpeg, StartsWith("\xFF\xD8\xFF"));
}

TEST_F(SiteImages, AreRejectedIfUnsuitable) {
  const auto message = [&](const WrittenImage& image) {
    return thrown_message([&] { read(square(20), image); });
  };
  EXPECT_THAT(thrown_message([&] {
                read({Vector2d(300, 300), Vector2d(400, 400)});
              }),
              HasSubstr("ortho.tif: does not cover the site"));
  EXPECT_THAT(message({.has_16_bits = true}), HasSubstr("is not an image of 8 bits per colour"));
  EXPECT_THAT(message({.has_crs = false}), HasSubstr("has no coordinate reference system"));
  EXPECT_THAT(message({.has_position = false}), HasSubstr("has no georeference"));
}

}  // namespace
}  // namespace skycap::missions::site_data
