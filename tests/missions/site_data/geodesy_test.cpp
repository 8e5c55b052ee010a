// Transformation from reference systems to the site frame, compared with formulas, with
// GeographicLib, whose projections are independent of PROJ, and with cs2cs, PROJ's own program.
#include <bit>
#include <cstring>
#include <fstream>

#include <GeographicLib/UTMUPS.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/site_data/prior.h"
#include "missions/site_data/reference_system.h"
#include "missions/site_data/site_transform.h"
#include "tests/support/complaint.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Returns longitude, latitude and height.
Vector3d geodetic(const ReferenceRequest& request, Vector3d position) {
  geodetic_transform(request).apply({&position, 1});
  return position;
}

Vector3d in_site(const std::string& crs, const flight::GeodeticPoint& origin, Vector3d position) {
  Source source;
  source.crs = crs;
  source.vertical = HeightDatum::ellipsoid;
  SiteTransform(source, {}, {.origin = origin}).to_site({&position, 1});
  return position;
}

/// Easting and northing in UTM by GeographicLib, with convergence and scale.
struct OnMap {
  double east, north, convergence, scale;
};
OnMap utm(double latitude, double longitude, int zone) {
  int used_zone = 0;
  bool is_north = false;
  OnMap map{};
  GeographicLib::UTMUPS::Forward(latitude, longitude, used_zone, is_north, map.east, map.north,
                                 map.convergence, map.scale, zone);
  return map;
}

/// Returns a big-endian value from a file.
template <typename Value>
Value big_endian(const std::string& bytes, std::size_t position) {
  std::array<char, sizeof(Value)> turned;
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(position), sizeof(Value),
              turned.rbegin());
  return std::bit_cast<Value>(turned);
}

// Reads and interpolates the published grid itself (EGM96, 15').
TEST(Geodesy, MatchesPublishedGeoidGrid) {
  std::ifstream stream("/usr/share/proj/egm96_15.gtx", std::ios::binary);
  if (!stream) GTEST_SKIP() << "Debian's proj-data is not there";
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  const auto south = big_endian<double>(bytes, 0), west = big_endian<double>(bytes, 8),
             step_north = big_endian<double>(bytes, 16), step_east = big_endian<double>(bytes, 24);
  const auto columns = static_cast<std::size_t>(big_endian<std::int32_t>(bytes, 36));
  const auto node = [&](double row, double column) {
    const auto index =
        static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column) % columns;
    return static_cast<double>(big_endian<float>(bytes, 40 + 4 * index));
  };
  for (double latitude = -88.0; latitude < 89.0; latitude += 12.7) {
    for (double longitude = -179.0; longitude < 179.0; longitude += 27.1) {
      const double row = (latitude - south) / step_north,
                   column = std::fmod(longitude - west + 720.0, 360.0) / step_east;
      const double r = std::floor(row), c = std::floor(column), v = row - r, u = column - c;
      const double expected = (1 - v) * ((1 - u) * node(r, c) + u * node(r, c + 1)) +
                              v * ((1 - u) * node(r + 1, c) + u * node(r + 1, c + 1));
      // In single precision, 100 m has a resolution of 4 micrometres.
      EXPECT_NEAR(egm96_undulation(latitude, longitude), expected, 1e-4)
          << latitude << ", " << longitude;
    }
  }
}

// echo LAT LON 0 | cs2cs EPSG:4326+5773 EPSG:4979 -f %.6f
TEST(Geodesy, MatchesKnownGeoidUndulations) {
  EXPECT_NEAR(egm96_undulation(51.7534, -1.254), 47.760744, 1e-6);
  EXPECT_NEAR(egm96_undulation(48.75, 11.42), 46.466337, 1e-6);
  EXPECT_NEAR(egm96_undulation(0.0, 0.0), 17.161579, 1e-6);
  EXPECT_NEAR(egm96_undulation(13.08, 80.27), -92.245137, 1e-6);
}

// 1e-9 degrees correspond to 0.1 mm.
TEST(Geodesy, MatchesUtmProjection) {
  const ReferenceRequest request{.crs = "EPSG:32632", .vertical = HeightDatum::ellipsoid};
  for (double latitude = 1.0; latitude < 84.0; latitude += 9.0) {
    for (double longitude = 6.0; longitude <= 12.0; longitude += 1.3) {
      const OnMap map = utm(latitude, longitude, 32);
      const Vector3d position = geodetic(request, {map.east, map.north, 380.0});
      EXPECT_NEAR(position.y(), latitude, 1e-9);
      EXPECT_NEAR(position.x(), longitude, 1e-9);
      EXPECT_EQ(position.z(), 380.0);
    }
  }
}

TEST(Geodesy, ConvertsHeightsAboveGeoidOrPad) {
  ReferenceRequest request{.crs = "EPSG:25832", .takeoff_height = 400.0};
  request.vertical = HeightDatum::geoid;
  const Vector3d position(677863.1, 5402477.3,
                          100.0);  // echo 48.749889290871 11.419734136004 100 |
  EXPECT_NEAR(geodetic(request, position).z(), 146.466455, 1e-6);  // cs2cs EPSG:4326+5773 EPSG:4979
  EXPECT_THAT(geodetic_transform(request).notes,
              testing::ElementsAre(AllOf(HasSubstr("EGM96"), HasSubstr("1 m"))));
  request.vertical = HeightDatum::takeoff;
  EXPECT_NEAR(geodetic(request, position).z(), 500.0, 1e-9);
  request.takeoff_height.reset();
  EXPECT_THAT([&] { geodetic_transform(request); },
              ThrowsMessage<Error>(HasSubstr("vertical: takeoff requires flight.takeoff")));
}

// Errors of substitute transformations are within the limits that PROJ states, and they are added
// up.
TEST(Geodesy, AddsErrorsOfSubstitutes) {
  ReferenceRequest request{.crs = "EPSG:27700"};  // Debian has no OSTN15
  request.vertical = HeightDatum::ellipsoid;
  request.near = flight::GeodeticPoint{51.6965, -1.278, 0.0};
  const GeodeticTransform helmert = geodetic_transform(request);
  EXPECT_EQ(helmert.substitution_error, 2.0);  // projinfo -s EPSG:27700 -t EPSG:4326 --summary
  EXPECT_THAT(helmert.notes, testing::ElementsAre(HasSubstr("is used instead of")));
  const Vector3d position = geodetic(request, {450000.0, 200000.0, 0.0});
  EXPECT_NEAR(position.y(), 51.696528816, 1e-8);  // echo 450000 200000 | cs2cs EPSG:27700 EPSG:4326
  EXPECT_NEAR(position.x(), -1.277971385, 1e-8);
  request.vertical = HeightDatum::geoid;
  EXPECT_EQ(geodetic_transform(request).substitution_error, 3.0);
  EXPECT_EQ(geodetic_transform({.crs = "EPSG:25832", .vertical = HeightDatum::ellipsoid})
                .substitution_error,
            0.0);
}

// echo 48.763 11.3985 330 | cs2cs EPSG:4326+5773 EPSG:4979 -f %.6f
TEST(Geodesy, UsesGeoidForThreeAxisSystemWhenSet) {
  ReferenceRequest request{.crs = "EPSG:4979"};
  EXPECT_EQ(geodetic(request, {11.3985, 48.763, 330.0}).z(), 330.0);
  request.vertical = HeightDatum::geoid;
  EXPECT_NEAR(geodetic(request, {11.3985, 48.763, 330.0}).z(), 376.490242, 1e-6);
}

TEST(Geodesy, RejectsMissingGeoidGridUnlessVerticalIsSet) {
  ReferenceRequest request{.crs = "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH"};
  EXPECT_THAT(
      [&] { geodetic_transform(request); },
      ThrowsMessage<Error>(AllOf(HasSubstr("DHHN2016"), testing::ContainsRegex("[Gg][Cc][Gg]2016"),
                                 HasSubstr("vertical: geoid"))));
  request.vertical = HeightDatum::geoid;
  const Vector3d position = geodetic(request, {677863.1, 5402477.3, 100.0});
  EXPECT_NEAR(position.z(), 146.466455, 1e-6);
}

TEST(Geodesy, RejectsInvalidReferenceSystems) {
  for (const char* crs : {"EPSG:1", "nonsense", "EPSG:4978", "EPSG:5773", "+proj=pipeline"}) {
    EXPECT_THAT(testing_support::thrown_message(
                    [&] { geodetic_transform({.crs = crs, .vertical = HeightDatum::ellipsoid}); }),
                testing::HasSubstr(crs))
        << crs;
  }
}

TEST(Geodesy, ReadsEastFirstByDefault) {
  // EPSG:4326 has latitude first and EPSG:31467 northing first, but files do not.
  const ReferenceRequest plain{.crs = "EPSG:4326", .vertical = HeightDatum::ellipsoid};
  EXPECT_TRUE(geodetic(plain, {11.4, 48.7, 5.0}).isApprox(Vector3d(11.4, 48.7, 5.0), 1e-12));
  ReferenceRequest by_letter = plain;
  by_letter.is_latitude_first = true;
  EXPECT_TRUE(geodetic(by_letter, {48.7, 11.4, 5.0}).isApprox(Vector3d(11.4, 48.7, 5.0), 1e-12));
  const ReferenceRequest map{.crs = "EPSG:31467", .vertical = HeightDatum::ellipsoid};
  // echo 5429191 3451262 | cs2cs EPSG:31467 EPSG:4326
  EXPECT_NEAR(geodetic(map, {3451262.0, 5429191.0, 0.0}).y(), 48.998099132, 1e-8);
  EXPECT_NEAR(geodetic(map, {3451262.0, 5429191.0, 0.0}).x(), 8.332915889, 1e-8);
}

/// A metre on the map is 0.9996 m on the ground at the central meridian. At the border of the zone
/// it is 1.0004 m, and grid north points east of true north.
TEST(Geodesy, CorrectsGridScaleAndConvergence) {
  for (const double longitude : {9.0, 10.5, 12.0}) {
    const flight::GeodeticPoint origin{48.0, longitude, 0.0};
    const OnMap map = utm(origin.latitude_deg, origin.longitude_deg, 32);
    const Vector3d a = in_site("EPSG:32632", origin, {map.east, map.north - 50.0, 0.0});
    const Vector3d b = in_site("EPSG:32632", origin, {map.east, map.north + 50.0, 0.0});
    EXPECT_LT((0.5 * (a + b)).norm(), 1e-3);
    EXPECT_NEAR((b - a).norm(), 100.0 / map.scale, 1e-5);
    EXPECT_NEAR(std::atan2(b.x() - a.x(), b.y() - a.y()), map.convergence * M_PI / 180.0, 1e-7);
  }
}

/// Only the curvature matters here: a point 10 km away on the ellipsoid is d^2 / 2 R below the
/// plane.
TEST(Geodesy, AccountsForEarthCurvature) {
  const Vector3d position = in_site("EPSG:4326", {0.0, 0.0, 0.0}, {0.0, 0.09, 0.0});
  // Radius of the meridian at the equator.
  const double radius = 6378137.0 * (1.0 - 0.00669437999014);
  const double angle = 0.09 * M_PI / 180.0;
  EXPECT_NEAR(position.y(), radius * std::sin(angle), 1e-3);
  EXPECT_NEAR(position.z(), -radius * (1.0 - std::cos(angle)), 1e-3);
}

TEST(Geodesy, CrossesTheAntimeridian) {
  const double metres = 6378137.0 * M_PI / 180.0;  // length of a degree at the equator
  const Vector3d position = in_site("EPSG:4326", {0.0, 179.9999, 0.0}, {-179.9999, 0.0, 0.0});
  EXPECT_NEAR(position.x(), 0.0002 * metres, 1e-3);
  const Vector3d back = in_site("EPSG:4326", {0.0, -179.9999, 0.0}, {179.9999, 0.0, 0.0});
  EXPECT_NEAR(back.x(), -0.0002 * metres, 1e-3);
  // UTM zone 60 ends there. Eastings continue beyond its border.
  const OnMap map = utm(-17.0, -179.9, 60);
  const Vector3d fiji = in_site("EPSG:32760", {-17.0, -179.9, 0.0}, {map.east, map.north, 0.0});
  EXPECT_LT(fiji.norm(), 1e-3);
}

TEST(Geodesy, IsCorrectAtPoles) {
  const flight::GeodeticPoint pole{90.0, 0.0, 0.0};
  const double metres =
      6399593.6258 * M_PI / 180.0;  // length of a degree there: polar radius of curvature
  const Vector3d east = in_site("EPSG:4326", pole, {90.0, 89.999, 0.0});
  EXPECT_NEAR(east.x(), 0.001 * metres, 1e-3);
  EXPECT_NEAR(east.y(), 0.0, 1e-6);
  const Vector3d beyond = in_site("EPSG:4326", pole, {180.0, 89.999, 0.0});
  EXPECT_NEAR(beyond.y(), 0.001 * metres, 1e-3);
  // Polar stereographic projection: its grid north is along the meridian of 180 degrees.
  EXPECT_LT(in_site("EPSG:32661", pole, {2000000.0, 2000000.0, 0.0}).norm(), 1e-3);
}

TEST(Geodesy, ConvertsFeet) {
  // Oregon Lambert (ft), EPSG:2994. Heights are also in feet, because no other unit is set.
  Source source;
  source.crs = "EPSG:2994";
  source.vertical = HeightDatum::ellipsoid;
  const flight::GeodeticPoint origin{44.05, -123.07, 0.0};
  const SiteTransform transform(source, {}, {.origin = origin});
  std::array<Vector3d, 2> positions = {Vector3d(636500, 849000, 0), Vector3d(636500, 849000, 1000)};
  transform.to_site(positions);
  EXPECT_NEAR((positions[1] - positions[0]).norm(), 304.8, 1e-6);
  EXPECT_NEAR(transform.metres_per_unit().x(), 0.3048, 1e-12);
  EXPECT_THAT(transform.notes(), testing::Contains(HasSubstr("units of 0.304800 m")));
}

// A wall of 100 ft with its base at 1000 ft. Ellipsoidal height of the base: echo 44.050126698
// -123.071508372 304.8 | cs2cs EPSG:4326+5773 EPSG:4979 -f %.6f
TEST(Geodesy, ConvertsHeightsInFeetOfReferenceSystem) {
  Source source;
  source.file = "wall.gml";
  source.crs = "EPSG:2994+8228";  // heights in feet, NAVD88
  const SiteFrame site{.origin = flight::GeodeticPoint{44.05, -123.07, 0.0}};
  for (const HeightDatum datum : {HeightDatum::geoid, HeightDatum::ellipsoid}) {
    source.vertical = datum;
    const SiteTransform transform(source, {}, site);
    std::array<Vector3d, 2> wall = {Vector3d(636500, 849000, 1000), Vector3d(636500, 849000, 1100)};
    transform.to_geodetic(wall);
    EXPECT_NEAR(wall[0].z(), datum == HeightDatum::geoid ? 282.406812 : 304.8, 1e-6);
    EXPECT_NEAR(wall[1].z() - wall[0].z(), 30.48, 1e-6);
    EXPECT_NEAR(transform.metres_per_unit().z(), 0.3048, 1e-12);
  }
  source.unit = 1.0;
  EXPECT_THAT([&] { SiteTransform(source, {}, site); },
              ThrowsMessage<Error>(HasSubstr("wall.gml: unit conflicts with")));
}

}  // namespace
}  // namespace skycap::missions::site_data
