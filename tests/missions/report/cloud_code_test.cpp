#include "missions/report/cloud_code.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "missions/report/script_text.h"

namespace skycap::missions::report {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Decodes bit by bit, independently of page/cloud.js, according to the description in the header.
struct Decoded {
  std::vector<Vector3d> positions;
  std::vector<std::vector<std::uint16_t>> attributes;
};

Decoded decode(const CloudCode& code) {
  const auto planes = static_cast<std::size_t>((3 * code.bits + 7) / 8);
  std::size_t size = planes * code.points;
  for (const auto& attribute : code.attributes) {
    size += (attribute.values > 256 ? 2 : 1) * code.points;
  }
  std::vector<unsigned char> bytes(size + 1);
  uLongf unpacked = bytes.size();
  EXPECT_EQ(uncompress(bytes.data(), &unpacked, reinterpret_cast<const Bytef*>(code.bytes.data()),
                       code.bytes.size()),
            Z_OK);
  EXPECT_EQ(unpacked, size);
  Decoded decoded;
  std::uint64_t key = 0;
  for (std::size_t i = 0; i < code.points; ++i) {
    for (std::size_t p = 0; p < planes; ++p)
      key += std::uint64_t{bytes[p * code.points + i]} << 8 * p;
    Vector3d cell = Vector3d::Zero();
    for (int bit = 0; bit < 3 * code.bits; ++bit) {
      if (key >> bit & 1) cell[bit % 3] += std::ldexp(1.0, bit / 3);
    }
    decoded.positions.emplace_back(code.origin + code.step * (cell + Vector3d::Constant(0.5)));
  }
  std::size_t at = planes * code.points;
  for (const auto& attribute : code.attributes) {
    std::vector<std::uint16_t> values(code.points, 0);
    for (int byte = 0; byte < (attribute.values > 256 ? 2 : 1); ++byte) {
      for (auto& value : values)
        value = static_cast<std::uint16_t>(value | bytes[at++] << 8 * byte);
    }
    decoded.attributes.push_back(std::move(values));
  }
  return decoded;
}

/// Returns noisy points on a sphere, like those of a survey.
std::vector<Vector3f> sphere(std::size_t count, double radius, double noise) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vector3f> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d direction =
        Vector3d{normal(random), normal(random), normal(random)}.normalized();
    points.emplace_back(
        ((radius + noise * normal(random)) * direction + Vector3d(100, -40, 7)).cast<float>());
  }
  return points;
}

std::vector<std::uint16_t> numbers(std::size_t count) {
  std::vector<std::uint16_t> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<std::uint16_t>(i % 1000));
  return values;
}

// Each point is decoded within half a step in each axis, with its own attributes.
TEST(CloudCode, ReadsBackWithinHalfAStep) {
  const auto points = sphere(5000, 20.0, 0.01);
  const auto ids = numbers(points.size());
  std::vector<std::uint16_t> small;
  for (const auto id : ids) small.push_back(id % 4);
  const CloudAttribute attributes[] = {{"id", ids}, {"small", small}};
  const CloudCode code = encode_cloud(points, attributes, 10'000);
  ASSERT_EQ(code.points, points.size());
  EXPECT_EQ(code.attributes[0].values, 1000U);
  EXPECT_EQ(code.attributes[1].values, 4U);
  const Decoded decoded = decode(code);
  std::vector<bool> is_found(points.size(), false);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(decoded.attributes[1][i], decoded.attributes[0][i] % 4);
    // Five points share this id. The decoded point must be close to one of them.
    bool is_there = false;
    for (std::size_t k = decoded.attributes[0][i]; k < points.size(); k += 1000) {
      const double off = (decoded.positions[i] - points[k].cast<double>()).cwiseAbs().maxCoeff();
      if (off > 0.5 * code.step * (1.0 + 1e-6) || is_found[k]) continue;
      is_found[k] = is_there = true;
      break;
    }
    EXPECT_TRUE(is_there) << i;
  }
}

// Spacing of random points on a surface: two points in a cube with a side of sqrt(2) spacings.
TEST(CloudCode, UsesStepOfEighthOfSpacing) {
  const CloudCode code = encode_cloud(sphere(20'000, 20.0, 0.0), {}, 100'000);
  // Spacing of a square grid.
  const double usual = std::sqrt(4.0 * std::numbers::pi * 400.0 / 20'000);
  EXPECT_GT(code.spacing, 0.4 * usual);
  EXPECT_LT(code.spacing, 1.5 * usual);
  EXPECT_DOUBLE_EQ(code.step, code.spacing / 8.0);
}

// Two distant points among many: cells cannot be smaller than 2^-16 of the extent.
TEST(CloudCode, LimitsStepByExtent) {
  std::vector<Vector3f> points = sphere(20'000, 1.0, 0.0);
  points.emplace_back(1e5F, 0.0F, 0.0F);
  const CloudCode code = encode_cloud(points, {}, 100'000);
  EXPECT_NEAR(code.step, 1e5 / 65536.0, 0.01);
  EXPECT_LE(code.bits, 16);
  EXPECT_NEAR((decode(code).positions.back() - points.back().cast<double>()).norm(), 0.0, 3.0);
}

// A downsampled cloud has the same distribution: each octant keeps its fraction.
TEST(CloudCode, DownsamplesEvenly) {
  const auto points = sphere(40'000, 20.0, 0.0);
  const CloudCode code = encode_cloud(points, {}, 4000);
  EXPECT_EQ(code.points, 4000U);
  EXPECT_EQ(code.of, 40'000U);
  std::size_t all = 0, kept = 0;
  for (const Vector3f& point : points) all += point.x() > 100 && point.y() > -40 && point.z() > 7;
  for (const Vector3d& point : decode(code).positions) {
    kept += point.x() > 100 && point.y() > -40 && point.z() > 7;
  }
  EXPECT_NEAR(static_cast<double>(kept), static_cast<double>(all) / 10.0, 12.0);
}

/// Returns view and incidence values like those of a survey. Each point belongs to the nearest of
/// 40 views around the sphere or, with equal probability, to another view nearby. A view has a
/// typical incidence angle, from which a third of its points differ by one step.
std::vector<std::vector<std::uint16_t>> survey_attributes(const std::vector<Vector3f>& points) {
  std::mt19937_64 random(4);
  std::vector<std::vector<std::uint16_t>> values(3);
  for (const Vector3f& point : points) {
    const double angle = std::atan2(point.y() + 40.0F, point.x() - 100.0F) + std::numbers::pi;
    const auto own = static_cast<std::uint16_t>(angle * 6.0 + static_cast<double>(random() % 3));
    values[0].push_back(own);
    values[1].push_back(point.z() > 24.0F ? 1 : 0);
    values[2].push_back(static_cast<std::uint16_t>(own % 8 + (random() % 3 == 0 ? 1 : 0)));
  }
  return values;
}

// Surface like that of a building. The limit on the number of characters follows from the size
// limit of the report.
TEST(CloudCode, IsCompact) {
  const auto points = sphere(200'000, 20.0, 0.01);
  const auto values = survey_attributes(points);
  const CloudAttribute attributes[] = {
      {"view", values[0]}, {"state", values[1]}, {"incidence", values[2]}};
  const CloudCode code = encode_cloud(points, attributes, 1'000'000);
  EXPECT_LT(static_cast<double>(base64(code.bytes).size()) / 200'000.0, 3.6);
}

TEST(CloudCode, EncodesEmptySingleAndEqualPoints) {
  EXPECT_EQ(decode(encode_cloud({}, {}, 10)).positions.size(), 0U);
  const std::vector<Vector3f> one = {{1, 2, 3}};
  EXPECT_NEAR((decode(encode_cloud(one, {}, 10)).positions.at(0) - Vector3d(1, 2, 3)).norm(), 0.0,
              1.0);
  const std::vector<Vector3f> same(7, Vector3f(5, 5, 5));
  EXPECT_EQ(decode(encode_cloud(same, {}, 10)).positions.size(), 7U);
}

TEST(CloudCode, IsDeterministic) {
  const auto points = sphere(3000, 2.0, 0.001);
  EXPECT_EQ(encode_cloud(points, {}, 1000).bytes, encode_cloud(points, {}, 1000).bytes);
}

}  // namespace
}  // namespace skycap::missions::report
