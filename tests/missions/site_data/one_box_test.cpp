// The same block in many formats is read as the same box.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
using testing_support::Cube;
using testing_support::make_source;
using testing_support::site_at_cube;

/// Converts geodetic to geocentric coordinates, independently of the product (Torge & Mueller,
/// Geodesy, 4.1). From these follow the site's east, north and up axes.
Vector3d geocentric(double latitude_deg, double longitude_deg, double height) {
  constexpr double a = 6378137.0, f = 1.0 / 298.257223563, e2 = f * (2.0 - f);
  const double phi = latitude_deg * M_PI / 180.0, lambda = longitude_deg * M_PI / 180.0;
  const double n = a / std::sqrt(1.0 - e2 * std::sin(phi) * std::sin(phi));
  return {(n + height) * std::cos(phi) * std::cos(lambda),
          (n + height) * std::cos(phi) * std::sin(lambda),
          (n * (1.0 - e2) + height) * std::sin(phi)};
}

Vector3d in_site(double latitude_deg, double longitude_deg, double height) {
  const flight::GeodeticPoint origin = *site_at_cube().origin;
  const double phi = origin.latitude_deg * M_PI / 180.0,
               lambda = origin.longitude_deg * M_PI / 180.0;
  const Vector3d d = geocentric(latitude_deg, longitude_deg, height) -
                     geocentric(origin.latitude_deg, origin.longitude_deg, origin.height);
  const Vector3d east(-std::sin(lambda), std::cos(lambda), 0.0),
      up(std::cos(phi) * std::cos(lambda), std::cos(phi) * std::sin(lambda), std::sin(phi));
  return {d.dot(east), d.dot(up.cross(east)), d.dot(up)};
}

/// Corners of the block by `cs2cs EPSG:25832 EPSG:4326 -f %.12f`.
const Vector3d low_corner = in_site(48.763121063013, 11.399097711873, 380.0);
const Vector3d high_corner = in_site(48.763208112067, 11.399237951357, 390.0);
const AlignedBox3d cube_box = [] {
  AlignedBox3d box;
  for (const double height : {380.0, 390.0}) {
    box.extend(in_site(48.763121063013, 11.399097711873, height));
    box.extend(in_site(48.763118231148, 11.399233667685, height));
    box.extend(in_site(48.763210943941, 11.399101995302, height));
    box.extend(in_site(48.763208112067, 11.399237951357, height));
  }
  return box;
}();

class BoxFixture : public testing::Test {
 protected:
  Prior read(const std::string& name, const std::string& bytes,
             const std::function<void(Source&)>& change = {}) {
    Source source = make_source(folder_.file(name, bytes));
    if (change) change(source);
    return read_prior(source, site_at_cube());
  }

  /// Checks that both corners are vertices and that the box contains all eight.
  static void expect_cube(const Prior& prior, double tolerance) {
    ASSERT_EQ(prior.objects.size(), 1U);
    double low = 1e9, high = 1e9;
    for (const Vector3d& vertex : prior.objects[0].mesh.vertices) {
      low = std::min(low, (vertex - low_corner).norm());
      high = std::min(high, (vertex - high_corner).norm());
    }
    EXPECT_LT(low, tolerance);
    EXPECT_LT(high, tolerance);
    EXPECT_LT((prior.box.min() - cube_box.min()).norm(), tolerance);
    EXPECT_LT((prior.box.max() - cube_box.max()).norm(), tolerance);
  }

  static constexpr double millimetre = 1e-3;
  const Cube cube_{};
  testing_support::TemporaryFolder folder_;
};

TEST_F(BoxFixture, ReadsCityGml) {
  const Prior prior = read("cube.gml", make_citygml(cube_), [](Source& s) { s.crs.clear(); });
  expect_cube(prior, millimetre);
  EXPECT_EQ(prior.format, "CityGML 2.0");
  EXPECT_EQ(prior.crs, "ETRS89 / UTM zone 32N");
  EXPECT_EQ(prior.objects[0].id, "cube");
  EXPECT_EQ(prior.objects[0].kind, "Building");
  EXPECT_EQ(prior.objects[0].attributes.at("function"), "31001_1000");
  EXPECT_EQ(prior.objects[0].mesh.triangles.size(), 12U);
  EXPECT_EQ(prior.objects[0].surfaces[0], SurfaceKind::ground);
  EXPECT_EQ(prior.objects[0].surfaces[2], SurfaceKind::roof);
  EXPECT_EQ(prior.objects[0].surfaces[4], SurfaceKind::wall);
}

TEST_F(BoxFixture, ReadsCityJson) {
  const Prior prior = read("cube.json", make_cityjson(cube_), [](Source& s) { s.crs.clear(); });
  expect_cube(prior, millimetre);
  EXPECT_EQ(prior.format, "CityJSON 2.0");
  EXPECT_EQ(prior.objects[0].surfaces[2], SurfaceKind::roof);
}

TEST_F(BoxFixture, ReadsOutlineWithHeight) {
  const Prior prior = read("cube.geojson", make_geojson(cube_), [](Source& s) {
    s.crs.clear();
    s.base = 380.0;
    s.height = 10.0;
  });
  expect_cube(prior, millimetre);
  EXPECT_EQ(prior.uncertainty, 1.0);
  EXPECT_EQ(prior.objects[0].id, "cube");
}

TEST_F(BoxFixture, ReadsOutlineOnTerrain) {
  Source source = make_source(folder_.file("cube.geojson", make_geojson(cube_)));
  source.vertical.reset();
  source.base_on_terrain = true;
  source.height = 10.0;
  const Prior prior =
      read_prior(source, site_at_cube(), [](const Eigen::Vector2d&) { return -5.0; });
  EXPECT_NEAR(prior.box.min().z(), -5.0, 1e-9);
  EXPECT_NEAR(prior.box.max().z(), 5.0, 1e-9);
  EXPECT_NEAR(prior.box.min().x(), cube_box.min().x(), 0.01);
}

TEST_F(BoxFixture, ReadsMesh) { expect_cube(read("cube.obj", make_obj(cube_)), millimetre); }

TEST_F(BoxFixture, ReadsGltfScene) {
  const Prior prior =
      read("cube.glb", make_glb(cube_), [this](Source& s) { s.offset = cube_.low; });
  expect_cube(prior, millimetre);
}

TEST_F(BoxFixture, ReadsRasterWithinOneCell) {
  const Prior prior = read("cube.asc", make_ascii_grid(cube_));
  EXPECT_EQ(prior.grid.columns, 28U);
  EXPECT_EQ(prior.grid.rows, 28U);
  AlignedBox3d roof;
  std::size_t without_height = 0;
  for (const Eigen::Vector3f& node : prior.grid.nodes) {
    if (!node.allFinite()) ++without_height;
    if (node.z() > 0.0F) roof.extend(node.cast<double>());
  }
  EXPECT_EQ(without_height, 28U);
  EXPECT_NEAR(roof.max().z(), high_corner.z(), millimetre);
  const Vector3d middle = 0.5 * (low_corner + high_corner);
  EXPECT_NEAR(roof.center().x(), middle.x(), 0.5);
  EXPECT_NEAR(roof.center().y(), middle.y(), 0.5);
  EXPECT_NEAR(roof.sizes().x(), cube_box.sizes().x(), 1.0);
}

TEST_F(BoxFixture, ReadsLasScan) {
  for (const auto& [minor, format] : {std::pair(0, 0),
                                      {1, 1},
                                      {2, 2},
                                      {2, 3},
                                      {3, 4},
                                      {3, 5},
                                      {4, 6},
                                      {4, 7},
                                      {4, 8},
                                      {4, 9},
                                      {4, 10}}) {
    SCOPED_TRACE(format);
    const Prior prior = read("cube.las", make_las(cube_, minor, format));
    ASSERT_EQ(prior.points.size(), 8U);
    EXPECT_LT((prior.points[0].cast<double>() - low_corner).norm(), millimetre);
    EXPECT_LT((prior.points[7].cast<double>() - high_corner).norm(), millimetre);
  }
}

TEST_F(BoxFixture, ReadsE57Scan) {
  const Prior prior = read("cube.e57", make_e57(cube_));
  ASSERT_EQ(prior.points.size(), 8U);
  EXPECT_LT((prior.points[0].cast<double>() - low_corner).norm(), millimetre);
  EXPECT_LT((prior.points[7].cast<double>() - high_corner).norm(), millimetre);
}

TEST_F(BoxFixture, ReportsHeightsInAllDatums) {
  const Prior prior = read("cube.gml", make_citygml(cube_));
  EXPECT_NEAR(prior.ellipsoid_heights->min, 380.0, millimetre);
  EXPECT_NEAR(prior.ellipsoid_heights->max, 390.0, millimetre);
  // echo 48.763 11.3985 0 | cs2cs EPSG:4326+5773 EPSG:4979
  EXPECT_NEAR(prior.sea_level_heights->min, 380.0 - 46.490242, millimetre);
}

// According to PROJ, EGM96 has an error of up to 1 m, which is added to the uncertainty of the
// file.
TEST_F(BoxFixture, AddsUncertaintyOfGeoidSubstitute) {
  const auto geoid = [](Source& s) { s.vertical = HeightDatum::geoid; };
  EXPECT_EQ(read("cube.gml", make_citygml(cube_)).uncertainty, 0.3);
  EXPECT_EQ(read("cube.gml", make_citygml(cube_), geoid).uncertainty, 1.3);
  EXPECT_EQ(read("cube.gml", make_citygml(cube_),
                 [&](Source& s) {
                   geoid(s);
                   s.uncertainty = 0.5;
                 })
                .uncertainty,
            1.5);
}

TEST_F(BoxFixture, AppliesConfiguredUpAxis) {
  const Prior prior = read("cube.glb", make_glb(cube_), [](Source& s) {
    s.crs.clear();
    s.vertical.reset();
    s.pose = SourcePose{};
    s.is_y_up = false;
  });
  // In the file, x is east, y is up and z is south.
  EXPECT_TRUE(
      prior.box.isApprox(AlignedBox3d(Vector3d(0, 0, -10), Vector3d(10, 10, 0)), millimetre));
}

// Property names do not determine the format.
TEST_F(BoxFixture, ReadsOutlineWithPropertiesOfOtherFormats) {
  std::string text = make_geojson(cube_);
  text.insert(text.find("\"function\""), R"("asset":"CityJSON","glTF":{"asset":1},)");
  const Prior prior = read("cube.geojson", text, [](Source& s) {
    s.base = 380.0;
    s.height = 10.0;
  });
  expect_cube(prior, millimetre);
  EXPECT_EQ(prior.objects[0].attributes.at("asset"), "CityJSON");
}

TEST_F(BoxFixture, RejectsInapplicableKeys) {
  const auto error_message = [&](const std::string& name, const std::string& bytes,
                                 const std::function<void(Source&)>& change) {
    return testing_support::thrown_message([&] { read(name, bytes, change); });
  };
  const std::string gml = make_citygml(cube_), las = make_las(cube_, 4, 6);
  using Change = std::function<void(Source&)>;
  for (const auto& [key, change] : std::initializer_list<std::pair<const char*, Change>>{
           {"base", [](Source& s) { s.base = 1.0; }},
           {"base", [](Source& s) { s.base_on_terrain = true; }},
           {"height", [](Source& s) { s.height = 1.0; }},
           {"min_height", [](Source& s) { s.min_height = 1.0; }},
           {"spacing", [](Source& s) { s.spacing = 1.0; }},
           {"select.classes", [](Source& s) { s.select.classes = {6}; }},
           {"select.layer", [](Source& s) { s.select.layer = "a"; }},
           {"up_axis", [](Source& s) { s.is_y_up = true; }}}) {
    EXPECT_THAT(error_message("cube.gml", gml, change),
                HasSubstr(key + std::string(" does not apply")));
  }
  for (const auto& [key, change] : std::initializer_list<std::pair<const char*, Change>>{
           {"select.id", [](Source& s) { s.select.ids = {"cube"}; }},
           {"select.attribute", [](Source& s) { s.select.attributes["a"] = "b"; }},
           {"select.lod", [](Source& s) { s.select.lod = 2.0; }}}) {
    EXPECT_THAT(error_message("cube.las", las, change),
                HasSubstr(key + std::string(" does not apply")));
  }
  EXPECT_THAT(error_message("cube.obj", make_obj(cube_),
                            [](Source& s) {
                              s.crs.clear();
                              s.pose = SourcePose{};
                            }),
              HasSubstr("vertical requires a coordinate reference system"));
  EXPECT_THAT(error_message("cube.geojson", make_geojson(cube_),
                            [](Source& s) {
                              s.base_on_terrain = true;
                              s.height = 1.0;
                            }),
              HasSubstr("vertical does not apply to this file"));
}

TEST_F(BoxFixture, ReadsMeshWithPoseInSiteFrame) {
  Cube near;
  near.low = {0.0, 0.0, 0.0};
  const Prior prior = read("cube.obj", make_obj(near), [](Source& s) {
    s.crs.clear();
    s.vertical.reset();
    s.pose = SourcePose{{12.0, -3.0, 1.0}, M_PI / 2.0};  // the file's y axis points east
  });
  EXPECT_LT((prior.box.min() - Vector3d(12, -13, 1)).norm(), 1e-9) << prior.box.min();
  EXPECT_LT((prior.box.max() - Vector3d(22, -3, 11)).norm(), 1e-9) << prior.box.max();
}

TEST_F(BoxFixture, ReadsCentimetresWithYUp) {
  Cube near;
  near.low = {0.0, 0.0, 0.0};
  near.size = {1000.0, 500.0, 200.0};
  const Prior prior = read("cube.obj", make_obj(near), [](Source& s) {
    s.crs.clear();
    s.vertical.reset();
    s.pose = SourcePose{};
    s.unit = 0.01;
    s.is_y_up = true;
  });
  EXPECT_TRUE(prior.box.isApprox(AlignedBox3d(Vector3d(0, -2, 0), Vector3d(10, 0, 5)), 1e-9));
}

TEST_F(BoxFixture, RejectsSwappedAxes) {
  Cube swapped;
  swapped.low = {5403900.0, 676300.0, 380.0};
  EXPECT_THAT([&] { read("cube.gml", make_citygml(swapped)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("cube.gml: "), HasSubstr("48.763"),
                                         HasSubstr("axes may be swapped"))));
}

TEST_F(BoxFixture, RejectsDataFarFromSite) {
  Cube far;
  far.low.x() += 51'000.0;
  EXPECT_THAT([&] { read("cube.json", make_cityjson(far)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("more than 50 km from the site at latitude "
                                                   "48.763000, longitude 11.398500"),
                                         testing::Not(HasSubstr("swapped")))));
}

TEST_F(BoxFixture, RejectsMissingVerticalDatum) {
  EXPECT_THAT([&] { read("cube.gml", make_citygml(cube_), [](Source& s) { s.vertical.reset(); }); },
              ThrowsMessage<Error>(HasSubstr("set vertical: ellipsoid, geoid or takeoff")));
}

TEST_F(BoxFixture, RejectsMapCoordinatesWithoutCrs) {
  const auto nowhere = [](Source& s) {
    s.crs.clear();
    s.vertical.reset();
  };
  EXPECT_THAT([&] { read("cube.obj", make_obj(cube_), nowhere); },
              ThrowsMessage<Error>(HasSubstr("more than 50 km from the site")));
}

TEST_F(BoxFixture, AppliesSelection) {
  const auto select = [](const std::function<void(Selection&)>& change) {
    return [=](Source& s) { change(s.select); };
  };
  const std::string text = make_citygml(cube_);
  EXPECT_EQ(read("a.gml", text, select([](Selection& s) { s.ids = {"cube"}; })).objects.size(), 1U);
  EXPECT_EQ(
      read("a.gml", text, select([](Selection& s) { s.attributes["function"] = "31001_1000"; }))
          .objects.size(),
      1U);
  EXPECT_THAT([&] { read("a.gml", text, select([](Selection& s) { s.ids = {"ball"}; })); },
              ThrowsMessage<Error>(HasSubstr("no object with id ball; it contains cube")));
  EXPECT_THAT([&] { read("a.gml", text, select([](Selection& s) { s.lod = 3.0; })); },
              ThrowsMessage<Error>(HasSubstr("that match select")));
}

}  // namespace
}  // namespace skycap::missions::site_data
