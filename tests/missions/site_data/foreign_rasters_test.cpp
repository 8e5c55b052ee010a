// Rasters whose no-data cells are not marked by a declared number.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/site_data/prior.h"
#include "tests/missions/site_data/gdal_files.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::WrittenRaster;

class ForeignRaster : public testing::Test {
 protected:
  Prior read(const WrittenRaster& raster, const std::function<void(Source&)>& change = {}) {
    Source source;
    source.file = folder_.path() / "ground.tif";
    testing_support::write_raster(source.file, raster);
    source.role = Role::terrain;
    source.vertical = HeightDatum::ellipsoid;
    if (change) change(source);
    // 500005 5315995 in EPSG:25832.
    return read_prior(source, {.origin = flight::GeodeticPoint{47.997254, 9.000067, 500.0}});
  }
  /// Checks that row 2 has no heights and that all others are 500 or 512 m.
  static void expect_hole(const Prior& prior) {
    std::size_t without = 0;
    for (std::size_t i = 0; i < prior.grid.nodes.size(); ++i) {
      if (prior.grid.nodes[i].allFinite()) continue;
      ++without;
      EXPECT_EQ(i / 10, 2U);
    }
    EXPECT_EQ(without, 10U);
    EXPECT_NEAR(prior.box.min().z(), 0.0, 0.01);
    EXPECT_NEAR(prior.box.max().z(), 12.0, 0.01);
  }
  testing_support::TemporaryFolder folder_;
};

TEST_F(ForeignRaster, IgnoresMaskedCells) {
  expect_hole(read({.hole = -9999.0, .has_nodata = true}));
  expect_hole(read({.hole = 0.0, .has_mask = true}));
  expect_hole(read({.hole = 0.0, .has_alpha = true}));
  expect_hole(read({.hole = -32767.0, .has_alpha = true}));
}

TEST_F(ForeignRaster, IgnoresCommonNodataHeights) {
  for (const double hole : {-9999.0, -32767.0, -32768.0, 32767.0, 65535.0, -3.4028235e38, 1e20}) {
    SCOPED_TRACE(hole);
    const Prior prior = read({.hole = hole});
    expect_hole(prior);
    EXPECT_THAT(
        prior.notes,
        Contains(HasSubstr("10 cells without valid ground height ignored: heights such as ")));
  }
  const Prior whole = read({});
  EXPECT_EQ(whole.grid.nodes.size(), 100U);
  EXPECT_NEAR(whole.box.sizes().z(), 12.0, 0.01);
  EXPECT_THAT(whole.notes, IsEmpty());
}

TEST_F(ForeignRaster, ReadsBandUnitsAndRejectsUnknownOnes) {
  // 500 and 512 m, stored in each of these units.
  for (const auto& [unit, metres] : std::initializer_list<std::pair<const char*, double>>{
           {"feet", 0.3048}, {"US survey foot", 1200.0 / 3937.0}, {"cm", 0.01}, {"Metre", 1.0}}) {
    const Prior prior = read({.unit = unit});
    EXPECT_NEAR(prior.box.max().z(), 512.0 * metres - 500.0, 0.01) << unit;
    EXPECT_NEAR(prior.box.sizes().z(), 12.0 * metres, 0.01) << unit;
  }
  EXPECT_THAT(testing_support::thrown_message([&] { read({.unit = "cubits"}); }),
              HasSubstr("has heights in an unknown unit: 'cubits'; set unit"));
  EXPECT_NEAR(read({.unit = "cubits"}, [](Source& s) { s.unit = 1.0; }).box.sizes().z(), 12.0,
              0.01);
  EXPECT_THAT(read({.bands = 3}).notes, Contains(HasSubstr("the first of 3 bands")));
}

TEST_F(ForeignRaster, RejectsImpossibleHeights) {
  EXPECT_THAT(testing_support::thrown_message(
                  [&] { read({.hole = -9999.0}, [](Source& s) { s.unit = 1000.0; }); }),
              HasSubstr("heights must be from -500 to 9000 m; one height is "));
}

TEST_F(ForeignRaster, RejectsDegreesWithoutReferenceSystem) {
  Source source;
  source.file = folder_.file("ground.asc",
                             "ncols 2\nnrows 2\nxllcorner 9\nyllcorner 48\ncellsize 0.0001\n"
                             "500 500\n500 500\n");
  source.role = Role::terrain;
  EXPECT_THAT(testing_support::thrown_message([&] {
                read_prior(source, {.origin = flight::GeodeticPoint{48.0, 9.0, 500.0}});
              }),
              HasSubstr("may be degrees; set crs: EPSG:4326, or set place if they are in metres"));
}

}  // namespace
}  // namespace skycap::missions::site_data
