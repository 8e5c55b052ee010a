#include "missions/photos/photo_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/io/file.h"
#include "tests/missions/photos/test_plan.h"

namespace skycap::missions::photos {
namespace {

TEST(PhotoFiles, AreStagedInThePackage) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "photo_files_test";
  {
    geometry::OutputFolder folder(path);
    stage_photo_tables(test_plan(), flight::Site{{51.75, -1.25, 111.5}, {}}, {}, folder);
    folder.commit();
  }
  EXPECT_THAT(geometry::read_file(path / "photos.csv"), testing::StartsWith("name,event,time_s,"));
  EXPECT_THAT(geometry::read_file(path / "geo.txt"), testing::StartsWith("EPSG:4326\n"));
  std::filesystem::remove_all(path);
}

}  // namespace
}  // namespace skycap::missions::photos
