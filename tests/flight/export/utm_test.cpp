#include "flight/export/utm.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <proj.h>

#include "geometry/error.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

using Context = std::unique_ptr<PJ_CONTEXT, decltype(&proj_context_destroy)>;
using Object = std::unique_ptr<PJ, decltype(&proj_destroy)>;

/// Radcliffe Square in Oxford; a position just south of the equator in a zone that extends north of
/// it; a position in the far south near the border of its zone.
const Site oxford{{51.75343, -1.25401, 110.0}, {}};
const Site quito{{-0.002, -78.45, 2850.0}, {}};
const Site ushuaia{{-54.8, -66.02, 40.0}, {}};

/// Returns the length of the WGS84 meridian from the equator, by Simpson's rule.
double meridian(double latitude) {
  constexpr double a = 6378137.0, f = 1.0 / 298.257223563, e2 = f * (2.0 - f);
  const auto curvature = [](double phi) {
    const double sine = std::sin(phi);
    return a * (1.0 - e2) / std::pow(1.0 - e2 * sine * sine, 1.5);
  };
  constexpr int steps = 1000;
  const double step = latitude / steps;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    sum += curvature(i * step) + 4.0 * curvature((i + 0.5) * step) + curvature((i + 1) * step);
  }
  return sum * step / 6.0;
}

// Closed form: on the central meridian the easting is 500 km and the northing is 0.9996 times the
// length of the meridian.
TEST(Utm, MatchesClosedFormOnCentralMeridian) {
  for (const double latitude_deg : {0.0, 10.0, 51.0, 83.0}) {
    const UtmProjection utm({{latitude_deg, -3.0, 12.0}, {}});
    const Vector3d position = utm.to_map(Vector3d::Zero());
    EXPECT_EQ(utm.epsg(), 32630);
    EXPECT_NEAR(position.x(), 500'000.0, 1e-6);
    EXPECT_NEAR(position.y(), 0.9996 * meridian(latitude_deg * std::numbers::pi / 180.0), 1e-4);
    EXPECT_NEAR(position.z(), 12.0, 1e-8);  // rounding error at 6,378 km
  }
}

// Compares all three coordinates with PROJ, to 0.1 mm, for the coordinate system that is written to
// files. The last point is north of the equator, where the false northing of Quito's zone still
// applies.
TEST(Utm, MatchesProjForWrittenWkt) {
  const Context context(proj_context_create(), proj_context_destroy);
  for (const Site& site : {oxford, quito, ushuaia}) {
    const UtmProjection utm(site);
    const LocalFrame frame(site.origin);
    const Object map(proj_create(context.get(), utm.wkt().c_str()), proj_destroy);
    const Object earth(proj_create(context.get(), "EPSG:4979"), proj_destroy);
    ASSERT_TRUE(map && earth) << utm.wkt();
    const Object pipeline(
        proj_create_crs_to_crs_from_pj(context.get(), earth.get(), map.get(), nullptr, nullptr),
        proj_destroy);
    ASSERT_TRUE(pipeline);
    for (const Vector3d& local : {Vector3d(0, 0, 0), Vector3d(120, -80, 35), Vector3d(-3, 900, 60),
                                  Vector3d(5000, 7000, 100)}) {
      const GeodeticPoint point = frame.to_geodetic(local);
      const PJ_COORD expected =
          proj_trans(pipeline.get(), PJ_FWD,
                     proj_coord(point.latitude_deg, point.longitude_deg, point.height, 0));
      const Vector3d position = utm.to_map(local);
      EXPECT_NEAR(position.x(), expected.xyz.x, 1e-4) << local.transpose();
      EXPECT_NEAR(position.y(), expected.xyz.y, 1e-4) << local.transpose();
      EXPECT_NEAR(position.z(), expected.xyz.z, 1e-4) << local.transpose();
    }
  }
}

TEST(Utm, MatchesExactProjectionNearOrigin) {
  for (const Site& site : {oxford, quito, ushuaia}) {
    const UtmProjection utm(site);
    for (const Vector3d& local : {Vector3d(999, 0, 0), Vector3d(-700, 700, 100),
                                  Vector3d(400, -800, 400), Vector3d(-200, -300, 50)}) {
      EXPECT_LT((utm.to_map(local) - utm.to_map_exactly(local)).norm(), 1e-5);
    }
  }
}

TEST(Utm, UsesGeoidHeightsWhenUndulationIsKnown) {
  Site site = oxford;
  site.geoid_undulation = 47.0;
  const UtmProjection utm(site);
  EXPECT_NEAR(utm.to_map({0, 0, 2.5}).z(), 110.0 + 2.5 - 47.0, 1e-8);
  const Context context(proj_context_create(), proj_context_destroy);
  const Object map(proj_create(context.get(), utm.wkt().c_str()), proj_destroy);
  ASSERT_EQ(proj_get_type(map.get()), PJ_TYPE_COMPOUND_CRS);
  const auto authority_code = [&](int part) {
    const Object crs(proj_crs_get_sub_crs(context.get(), map.get(), part), proj_destroy);
    return std::string(proj_get_id_auth_name(crs.get(), 0)) + ":" + proj_get_id_code(crs.get(), 0);
  };
  EXPECT_EQ(authority_code(0), "EPSG:32630");
  EXPECT_EQ(authority_code(1), "EPSG:5773");  // EGM96 height
  EXPECT_EQ(UtmProjection(ushuaia).epsg(), 32719);
}

TEST(Utm, RejectsPolarLatitudes) {
  EXPECT_THAT(
      [] {
        UtmProjection({{85.5, 0.0, 0.0}, {}});
      },
      testing::ThrowsMessage<Error>(HasSubstr("UTM is defined from 80 degrees south to 84")));
  EXPECT_THAT(testing_support::thrown_message([&] {
                UtmProjection({{95.0, 0.0, 0.0}, {}});
              }),
              testing::HasSubstr("latitude is 95.0"));
}

}  // namespace
}  // namespace skycap::flight
