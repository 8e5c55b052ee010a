// Comparison of densities with brute-force counts and closed-form values.
#include "missions/evaluation/surface_density.h"

#include <cstring>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/utm.h"
#include "geometry/error.h"

namespace skycap::missions::evaluation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

/// Returns a square of 10 m at z = 0 that faces up.
geometry::Mesh square() {
  geometry::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Returns a level square with a wall of 5 m above its east edge.
geometry::Mesh step() {
  geometry::Mesh mesh = square();
  mesh.vertices.insert(mesh.vertices.end(), {{10, 0, 5}, {10, 10, 5}});
  mesh.triangles.push_back({1, 4, 5});
  mesh.triangles.push_back({1, 5, 2});
  return mesh;
}

std::vector<Vector3f> random_points(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> position(-2.0F, 12.0F), up(-0.3F, 5.3F);
  std::vector<Vector3f> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(Vector3f{position(random), position(random), up(random)});
  return points;
}

TEST(SurfaceDensity, CountsEveryPointWithinTheRadius) {
  constexpr double radius = 0.5;
  const std::vector<Vector3f> points = random_points(5000, 7);
  DensityMeter one(density_samples(step(), {}, 0.5, 0.0), radius, 1),
      several(density_samples(step(), {}, 0.5, 0.0), radius, 4);
  one.add(points);
  for (std::size_t i = 0; i < points.size(); i += 1000) {
    several.add(std::span(points).subspan(i, 1000));
  }
  EXPECT_EQ(one.counts(), several.counts());
  const DensitySamples& samples = one.samples();
  for (std::size_t i = 0; i < samples.positions.size(); i += 7) {
    std::uint64_t near = 0;
    for (const Vector3f& point : points) {
      near += geometry::squared_distance(point, samples.positions[i]) <=
                      static_cast<float>(radius * radius)
                  ? 1
                  : 0;
    }
    EXPECT_EQ(one.counts()[i], near) << i;
  }
}

// A point grid with a spacing of 0.1 m has 100 points per square metre, also at the edges of the
// surface.
TEST(SurfaceDensity, IsThatOfAnEvenGridUpToTheEdges) {
  std::vector<Vector3f> points;
  for (int x = 0; x < 100; ++x) {
    for (int y = 0; y < 100; ++y) {
      points.emplace_back(0.1F * static_cast<float>(x) + 0.05F,
                          0.1F * static_cast<float>(y) + 0.05F, 0.0F);
    }
  }
  DensityMeter meter(density_samples(square(), {}, 0.1, 0.0), 1.0);
  meter.add(points);
  for (const double density : meter.densities()) EXPECT_NEAR(density, 100.0, 8.0);
  const DensityFigures figures = meter.figures(90.0).value();
  EXPECT_NEAR(figures.area, 100.0, 1e-6);
  EXPECT_NEAR(figures.mean, 100.0, 1.0);
  EXPECT_NEAR(figures.median, 100.0, 1.0);
  EXPECT_NEAR(figures.share, 1.0, 1e-9);
  EXPECT_NEAR(meter.figures(110.0)->share, 0.0, 1e-12);
  double sum = 0.0;
  for (const double share : figures.histogram) sum += share;
  EXPECT_NEAR(sum, 1.0, 1e-9);
  EXPECT_FALSE(meter.figures(1.0, SurfaceClass::wall));
}

// With points only on the floor, level surface is dense, and walls only at their base.
TEST(SurfaceDensity, TellsWallsFromLevelSurface) {
  std::vector<Vector3f> points;
  for (int x = 0; x < 100; ++x) {
    for (int y = 0; y < 100; ++y) {
      points.emplace_back(0.1F * static_cast<float>(x), 0.1F * static_cast<float>(y), 0.0F);
    }
  }
  DensityMeter meter(density_samples(step(), {}, 0.1, 0.0), 0.5);
  meter.add(points);
  EXPECT_GT(meter.figures(50.0, SurfaceClass::roof)->share, 0.9);
  EXPECT_NEAR(meter.figures(50.0, SurfaceClass::roof)->area, 100.0, 1.0);
  EXPECT_LT(meter.figures(50.0, SurfaceClass::wall)->share, 0.1);
  EXPECT_NEAR(meter.figures(50.0, SurfaceClass::wall)->area, 50.0, 1.0);
}

TEST(DensityRaster, EqualsCountingAllPoints) {
  const std::vector<Vector3f> points = random_points(20'000, 3);
  DensityRaster raster({Vector2d(0, 0), Vector2d(10, 7.3)}, 0.5);
  raster.add(points);
  ASSERT_EQ(raster.columns(), 20U);
  ASSERT_EQ(raster.rows(), 15U);
  for (std::size_t row = 0; row < raster.rows(); ++row) {
    for (std::size_t column = 0; column < raster.columns(); ++column) {
      std::uint32_t inside = 0;
      const double west = 0.5 * static_cast<double>(column);
      const double north = 7.3 - 0.5 * static_cast<double>(row);
      for (const Vector3f& point : points) {
        const double x = double{point.x()} - west, y = north - double{point.y()};
        inside += x >= 0.0 && x < 0.5 && y >= 0.0 && y < 0.5 ? 1 : 0;
      }
      EXPECT_EQ(raster.counts()[row * raster.columns() + column], inside) << row << " " << column;
    }
  }
}

template <typename Number>
Number at(const std::string& bytes, std::size_t offset) {
  Number number{};
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

/// Returns the offset of a tag's entry in the only directory.
std::size_t make_entry(const std::string& tiff, std::uint16_t tag) {
  const auto begin = at<std::uint32_t>(tiff, 4);
  for (std::uint16_t i = 0; i < at<std::uint16_t>(tiff, begin); ++i) {
    const std::size_t entry = begin + 2 + 12 * std::size_t{i};
    if (at<std::uint16_t>(tiff, entry) == tag) return entry;
  }
  ADD_FAILURE() << "no tag " << tag;
  return 0;
}

TEST(DensityRaster, GeoTiffHoldsPointsPerSquareMetre) {
  DensityRaster raster({Vector2d(-10, -5), Vector2d(10, 5)}, 2.0);
  raster.add(random_points(1000, 4));
  const std::string tiff = raster.geotiff(std::nullopt);
  EXPECT_EQ(tiff.substr(0, 4), std::string("II*\0", 4));
  EXPECT_EQ(at<std::uint32_t>(tiff, make_entry(tiff, 256) + 8), 10U);
  EXPECT_EQ(at<std::uint32_t>(tiff, make_entry(tiff, 257) + 8), 5U);
  const auto image = at<std::uint32_t>(tiff, make_entry(tiff, 273) + 8);
  ASSERT_EQ(tiff.size(), image + 4 * 50U);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_FLOAT_EQ(at<float>(tiff, image + 4 * i), static_cast<float>(raster.counts()[i]) / 4.0F);
  }
  EXPECT_EQ(raster.geotiff(std::nullopt), tiff);
}

// The corners have the correct map coordinates.
TEST(DensityRaster, GeoTiffIsPlacedInUtm) {
  const flight::Site site{{51.753458, -1.254022, 111.5}, 46.7};
  const DensityRaster raster({Vector2d(-100, -50), Vector2d(100, 50)}, 1.0);
  const std::string tiff = raster.geotiff(site);
  const std::size_t keys = at<std::uint32_t>(tiff, make_entry(tiff, 34735) + 8);
  EXPECT_EQ(at<std::uint16_t>(tiff, keys + 2 * 12), 3072);
  EXPECT_EQ(at<std::uint16_t>(tiff, keys + 2 * 15), 32630);
  const std::size_t matrix = at<std::uint32_t>(tiff, make_entry(tiff, 34264) + 8);
  const auto value = [&](std::size_t i) { return at<double>(tiff, matrix + 8 * i); };
  const flight::UtmProjection utm(site);
  for (const double column : {0.0, 200.0}) {
    for (const double row : {0.0, 100.0}) {
      const Eigen::Vector3d map = utm.to_map_exactly({-100.0 + column, 50.0 - row, 0.0});
      EXPECT_NEAR(value(0) * column + value(1) * row + value(3), map.x(), 0.01);
      EXPECT_NEAR(value(4) * column + value(5) * row + value(7), map.y(), 0.01);
    }
  }
}

TEST(DensityRaster, RejectsTooManyCells) {
  EXPECT_THROW(DensityRaster({Vector2d(0, 0), Vector2d(1e5, 1e5)}, 0.01), Error);
}

}  // namespace
}  // namespace skycap::missions::evaluation
