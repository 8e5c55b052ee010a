#include "survey/photo/stereo_quality.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/random_numbers.h"

namespace skycap::survey::photo {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double degree = geometry::radians_per_degree;

/// Returns observations of a point on a level surface from azimuth 0 at these angles from the
/// normal.
std::vector<Observation> observations_at(const std::vector<double>& angles_deg, float distance) {
  std::vector<Observation> result;
  for (const double angle : angles_deg) {
    const Vector3f ray(static_cast<float>(std::sin(angle * degree)), 0.0F,
                       static_cast<float>(std::cos(angle * degree)));
    result.push_back({ray, distance, ray.z(), static_cast<std::uint32_t>(result.size())});
  }
  return result;
}

StereoRule rule_of(double view_distance) {
  StereoRule rule;
  rule.view_distance = view_distance;
  return rule;
}

TEST(StereoPartners, CountPairsOfSuitableParallax) {
  const StereoPairs pairs(rule_of(10.0));
  const auto partners = [&](const std::vector<double>& angles) {
    return stereo_partners(observations_at(angles, 10.0F), pairs);
  };
  EXPECT_EQ(partners({}), -2);
  EXPECT_EQ(partners({0}), -1);
  EXPECT_EQ(partners({0, 4}), 0);  // Parallax too small.
  EXPECT_EQ(partners({0, 6}), 1);
  EXPECT_EQ(partners({-25, 25}), 0);   // Parallax too large.
  EXPECT_EQ(partners({0, 6, -6}), 2);  // Partners of the middle observation.
  EXPECT_EQ(partners({0, 10, 20, 30}), 3);
  EXPECT_EQ(partners({0, 30, 60}), 2);  // The parallax of the outer two is too large.
}

TEST(StereoPartners, HaveDistancesWithinAFactorOfTwo) {
  const StereoPairs pairs(rule_of(10.0));
  std::vector<Observation> two = observations_at({0, 20}, 6.0F);
  two[1].distance = 11.9F;
  EXPECT_EQ(stereo_partners(two, pairs), 1);
  two[1].distance = 12.1F;
  EXPECT_EQ(stereo_partners(two, pairs), 0);
}

TEST(Reconstructability, OfTwoObservationsIsSmithsClosedForm) {
  const StereoPairs pairs(rule_of(6.0));
  const double h = reconstructability(observations_at({-10, 10}, 6.0F), pairs);
  EXPECT_NEAR(h, 0.963 * 0.5 * std::cos(10.0 * degree), 0.002);
}

TEST(Reconstructability, UsesTheBest32Observations) {
  const StereoPairs pairs(rule_of(6.0));
  std::vector<Observation> many = observations_at(std::vector<double>(32, 0.0), 5.0F);
  for (std::size_t i = 0; i < many.size(); ++i) {
    const auto angle = static_cast<float>(0.02 * static_cast<double>(i));
    many[i].ray = Vector3f(std::sin(angle), 0.0F, std::cos(angle));
  }
  const double best = reconstructability(many, pairs);
  many.push_back(observations_at({40}, 11.0F).front());  // Farther away than all others.
  EXPECT_DOUBLE_EQ(reconstructability(many, pairs), best);
}

TEST(ExpectedCompleteness, GrowsWithPartners) {
  EXPECT_EQ(expected_completeness(-2), 0.0);
  EXPECT_EQ(expected_completeness(-1), 0.0);
  EXPECT_EQ(expected_completeness(0), 0.35);
  EXPECT_EQ(expected_completeness(3), 0.95);
  EXPECT_EQ(expected_completeness(6), 0.99);
  EXPECT_EQ(expected_completeness(60), 0.99);
  EXPECT_EQ(expected_threefold(2), 0.73);
  for (int k = -2; k < 8; ++k) {
    EXPECT_LE(expected_completeness(k), expected_completeness(k + 1));
    EXPECT_LE(expected_threefold(k), expected_completeness(k));
  }
}

TEST(NormalSigma, OfTwoPhotosIsTheIntersectionFormula) {
  constexpr double distance = 8.0, focal_length = 4000.0, gsd = distance / focal_length;
  for (const double parallax_deg : {10.0, 20.0, 40.0}) {
    const auto two = observations_at({-0.5 * parallax_deg, 0.5 * parallax_deg}, 8.0F);
    const double expected = gsd * 0.5 / (std::sqrt(2.0) * std::sin(0.5 * parallax_deg * degree));
    EXPECT_NEAR(normal_sigma(two, Vector3f::UnitZ(), focal_length), expected, 0.01 * expected);
  }
  EXPECT_TRUE(std::isinf(normal_sigma(observations_at({0}, 8.0F), Vector3f::UnitZ(), 4000.0)));
}

TEST(SamePositions, CountOnce) {
  const std::vector<Vector3d> positions{
      {0, 0, 0}, {0.2, 0, 0}, {0.4, 0, 0}, {5, 0, 0}, {5.1, 0, 0}};
  EXPECT_THAT(same_positions(positions, 0.3), ElementsAre(0, 0, 2, 3, 3));
}

std::string validation_error(const StereoRule& rule) {
  try {
    rule.validate();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(StereoRule, RejectsValuesOutOfRange) {
  StereoRule rule;
  EXPECT_EQ(validation_error(rule), "");
  rule.min_partners = 1;
  EXPECT_THAT(validation_error(rule), HasSubstr("min_partners is 1; it must be between 2 and 6"));
  rule = {};
  rule.max_incidence = 86.0 * degree;
  EXPECT_THAT(validation_error(rule), HasSubstr("max_incidence_deg is 86"));
  rule = {};
  rule.min_parallax = 41.0 * degree;
  EXPECT_THAT(validation_error(rule), HasSubstr("less than the maximum parallax"));
  rule.min_parallax = 0.5 * degree;
  EXPECT_THAT(validation_error(rule), HasSubstr("between 1 and 60 degrees"));
}

}  // namespace
}  // namespace skycap::survey::photo
