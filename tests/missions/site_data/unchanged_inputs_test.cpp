// Input files and their folders are never modified. The folders are read-only, and the checksums of
// all files are compared before and after reading.
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/record_log.h"
#include "missions/site_data/prior.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/missions/site_data/gdal_files.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using testing::Contains;
using testing::HasSubstr;

namespace fs = std::filesystem;

std::string read_bytes(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Returns the checksum and modification time of each file in a folder.
std::map<std::string, std::pair<std::uint32_t, fs::file_time_type>> compute_checksums(
    const fs::path& folder) {
  std::map<std::string, std::pair<std::uint32_t, fs::file_time_type>> sums;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    sums[entry.path().string()] = {geometry::compute_crc32(read_bytes(entry.path())),
                                   entry.last_write_time()};
  }
  return sums;
}

class InputFiles : public testing::Test {
 protected:
  /// Reads a file while its folder is read-only.
  Prior read(const fs::path& file, const std::function<void(Source&)>& change = {}) {
    const auto before = compute_checksums(folder_.path());
    fs::permissions(file.parent_path(), fs::perms::owner_read | fs::perms::owner_exec);
    Source source;
    source.file = file;
    source.vertical = HeightDatum::ellipsoid;
    if (change) change(source);
    Prior prior;
    try {
      prior = read_prior(source, {.origin = flight::GeodeticPoint{48.0, 9.0, 500.0}});
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
    }
    fs::permissions(file.parent_path(), fs::perms::owner_all);
    EXPECT_EQ(compute_checksums(folder_.path()), before) << file;
    return prior;
  }
  testing_support::TemporaryFolder folder_;
};

void set_base(Source& source) { source.base = 500.0; }

TEST_F(InputFiles, StayUnchangedWhenMapsAreRead) {
  for (const auto& [driver, name] :
       std::initializer_list<std::pair<const char*, const char*>>{{"GPKG", "a.gpkg"},
                                                                  {"ESRI Shapefile", "a.shp"},
                                                                  {"FlatGeobuf", "a.fgb"},
                                                                  {"GeoJSON", "a.geojson"},
                                                                  {"LIBKML", "a.kml"}}) {
    testing_support::write_map(folder_.path() / name,
                               {.driver = driver, .attributes = {{"height", "12"}}});
    EXPECT_NEAR(read(folder_.path() / name, set_base).box.max().z(), 12.0, 0.01) << name;
  }
}

TEST_F(InputFiles, StayUnchangedWhenDatabaseWithLogIsRead) {
  const fs::path live = folder_.path() / "live", left = folder_.path() / "left";
  fs::create_directories(live);
  fs::create_directories(left);
  testing_support::write_map(live / "hall.gpkg", {.attributes = {{"height", "12"}}});
  // State of the file while another program is writing it, or after that program was killed.
  testing_support::run_sql(
      live / "hall.gpkg",
      {"PRAGMA journal_mode=WAL", "PRAGMA wal_autocheckpoint=0", "UPDATE hall SET height='40'"},
      [&] {
        for (const char* name : {"hall.gpkg", "hall.gpkg-wal"}) {
          fs::copy_file(live / name, left / name);
        }
      });
  ASSERT_GT(fs::file_size(left / "hall.gpkg-wal"), 0U);
  const Prior prior = read(left / "hall.gpkg", set_base);
  EXPECT_NEAR(prior.box.max().z(), 40.0, 0.01);
  EXPECT_THAT(prior.notes,
              Contains(HasSubstr("read from a copy that includes the changes in its log")));
  // In WAL mode without a log, the file is read in place.
  fs::remove(left / "hall.gpkg-wal");
  EXPECT_NEAR(read(left / "hall.gpkg", set_base).box.max().z(), 12.0, 0.01);
}

TEST_F(InputFiles, StayUnchangedWhenShapefileWithoutIndexIsRead) {
  testing_support::write_map(folder_.path() / "a.shp",
                             {.driver = "ESRI Shapefile", .attributes = {{"height", "12"}}});
  fs::remove(folder_.path() / "a.shx");
  EXPECT_NEAR(read(folder_.path() / "a.shp", set_base).box.max().z(), 12.0, 0.01);
}

TEST_F(InputFiles, StayUnchangedWhenRasterIsRead) {
  testing_support::write_raster(folder_.path() / "a.tif", {.has_mask = true});
  read(folder_.path() / "a.tif");
}

TEST_F(InputFiles, StayUnchangedForAllOtherFormats) {
  const testing_support::Cube cube;
  const auto on_map = [](Source& source) {
    source.crs = "EPSG:25832";
    source.pose.reset();
  };
  const std::pair<const char*, std::string> files[] = {
      {"cube.gml", testing_support::make_citygml(cube)},
      {"cube.json", testing_support::make_cityjson(cube)},
      {"cube.obj", testing_support::make_obj(cube)},
      {"cube.asc", testing_support::make_ascii_grid(cube)},
      {"cube.las", testing_support::make_las(cube, 4, 6)},
      {"cube.e57", testing_support::make_e57(cube)},
      {"cube.glb", testing_support::make_glb(cube)}};
  for (const auto& [name, bytes] : files) {
    const fs::path file = folder_.file(name, bytes);
    const auto before = compute_checksums(folder_.path());
    fs::permissions(file.parent_path(), fs::perms::owner_read | fs::perms::owner_exec);
    Source source = testing_support::make_source(file);
    on_map(source);
    if (std::string(name) == "cube.glb") source.offset = cube.low;
    EXPECT_NO_THROW(read_prior(source, testing_support::site_at_cube())) << name;
    fs::permissions(file.parent_path(), fs::perms::owner_all);
    EXPECT_EQ(compute_checksums(folder_.path()), before) << name;
  }
}

}  // namespace
}  // namespace skycap::missions::site_data
