#include "sim/sensors/scan_pattern.h"

#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;

// Returns half a Velodyne: lasers with different elevations, delays and heights.
LidarConfig spinner() {
  LidarConfig config;
  config.firing_period = 55.296e-6;
  config.rotation_rate = -10.0;
  for (int i = 0; i < 8; ++i) {
    config.channels.resize(i + 1);
    config.channels[i] = {.elevation = (i % 2 ? 15 - i : -15 + i) * degree,
                          .azimuth = 0.1 * i * degree,
                          .delay = 2.304e-6 * i,
                          .height = 0.001 * i};
  }
  return config;
}

Vector3d direction(const Pulses& pulses, std::size_t slot) {
  return {pulses.direction[0][slot], pulses.direction[1][slot], pulses.direction[2][slot]};
}

// Closed-form direction at any time. A late block shows that precision does not decrease with time.
TEST(ScanPattern, MatchesClosedFormRotation) {
  const LidarConfig config = spinner();
  const ScanPattern pattern(config);
  Pulses pulses;
  for (const std::uint64_t block : {0ULL, 1ULL, 57ULL, 2'000'000'000ULL}) {
    pattern.aim(block, pulses);
    for (std::uint32_t firing = 0; firing < 32; ++firing) {
      for (std::size_t channel = 0; channel < 8; ++channel) {
        const Channel& laser = config.channels[channel];
        const double start = static_cast<double>(block * 32 + firing) * config.firing_period;
        const double turns =
            std::fmod(config.rotation_rate * start, 1.0) + config.rotation_rate * laser.delay;
        const double azimuth = 2.0 * std::numbers::pi * turns + laser.azimuth;
        const Vector3d expected(std::cos(laser.elevation) * std::cos(azimuth),
                                std::cos(laser.elevation) * std::sin(azimuth),
                                std::sin(laser.elevation));
        const std::size_t slot = pattern.slot(firing, channel);
        ASSERT_LT((direction(pulses, slot) - expected).norm(), 3e-7);
        ASSERT_NEAR(std::remainder(pulses.azimuth[slot] - azimuth, 2.0 * std::numbers::pi), 0,
                    1e-5);
        ASSERT_EQ(pulses.origin[2][slot], static_cast<float>(laser.height));
      }
    }
  }
}

TEST(ScanPattern, AssignsOneSlotPerPulse) {
  const ScanPattern pattern(spinner());
  std::set<std::size_t> slots;
  for (std::uint32_t firing = 0; firing < 32; ++firing) {
    for (std::size_t channel = 0; channel < 8; ++channel)
      slots.insert(pattern.slot(firing, channel));
  }
  EXPECT_EQ(slots.size(), 32U * 8U);
  EXPECT_EQ(*slots.rbegin(), 32U * 8U - 1);
}

// Ouster's geometry: lasers on a circle that rotates with the encoder.
TEST(ScanPattern, OffsetsLasersFromAxis) {
  LidarConfig config = spinner();
  config.radial_offset = 0.02767;
  for (Channel& channel : config.channels) channel.delay = 0.0;
  const ScanPattern pattern(config);
  Pulses pulses;
  pattern.aim(3, pulses);
  for (std::uint32_t firing = 0; firing < 32; ++firing) {
    const double encoder =
        2.0 * std::numbers::pi * config.rotation_rate * (96 + firing) * config.firing_period;
    const std::size_t slot = pattern.slot(firing, 5);
    EXPECT_NEAR(pulses.origin[0][slot], 0.02767 * std::cos(encoder), 1e-8);
    EXPECT_NEAR(pulses.origin[1][slot], 0.02767 * std::sin(encoder), 1e-8);
  }
}

// A line scanner with a field of view of 100 of 360 degrees emits this fraction of its pulses.
TEST(ScanPattern, EmitsOnlyInsideFieldOfView) {
  LidarConfig config;
  config.firing_period = 1e-5;
  config.rotation_rate = 100.0;  // 1000 pulses per revolution
  config.field_of_view = 100 * degree;
  const ScanPattern pattern(config);
  Pulses pulses;
  int emitted = 0;
  for (std::uint64_t block = 0; block < 125; ++block) {  // 4 revolutions
    pattern.aim(block, pulses);
    for (std::size_t slot = 0; slot < pattern.slots(); ++slot) {
      emitted += pulses.is_emitted[slot];
      const double off = std::acos(std::min(1.0, direction(pulses, slot).x()));
      ASSERT_EQ(pulses.is_emitted[slot] != 0, off <= 50 * degree + 1e-6);
    }
  }
  EXPECT_NEAR(emitted, 4 * 1000 * 100.0 / 360.0, 4 * 2);  // up to two pulses at the edges of a line
}

TEST(Refract, FollowsSnellsLawForOnePrism) {
  const double wedge = 12 * degree, index = 1.51;
  // Perpendicular entry: inside the glass, the beam meets the inclined face at the angle `wedge`.
  const double expected = std::asin(index * std::sin(wedge)) - wedge;
  const std::vector<WedgePrism> prisms = {{wedge, index, 0.0, 0.0, false}};
  const Vector3d beam = refract(prisms, 0.0, Vector3d::UnitX());
  EXPECT_NEAR(std::acos(beam.x()), expected, 1e-12);
  EXPECT_NEAR(beam.norm(), 1.0, 1e-12);
}

// For small wedges: theta = (n - 1) (w1 exp(i a1) + w2 exp(i a2)), the paraxial formula of a
// rosette.
TEST(Refract, FollowsParaxialFormulaForThinPrisms) {
  const double index = 1.51, wedge = 0.2 * degree;
  const std::vector<WedgePrism> prisms = {{wedge, index, -77.7, 0.3, false},
                                          {wedge, index, 121.6, 1.1, true}};
  for (const double time : {0.0, 0.0123, 1.7}) {
    const Vector3d beam = refract(prisms, time, Vector3d::UnitX());
    double y = 0.0, z = 0.0;
    for (const WedgePrism& prism : prisms) {
      const double angle = prism.phase + 2.0 * std::numbers::pi * prism.rotation_rate * time;
      y -= (index - 1.0) * wedge * std::cos(angle);
      z -= (index - 1.0) * wedge * std::sin(angle);
    }
    // The sign depends on the position of the thick side. It is the same for both prisms.
    const double sign = beam.y() * y + beam.z() * z > 0.0 ? 1.0 : -1.0;
    EXPECT_NEAR(beam.y(), sign * y, 1e-3 * wedge);
    EXPECT_NEAR(beam.z(), sign * z, 1e-3 * wedge);
  }
}

// Livox Mid-70: two aligned prisms of 29.7 degrees reach the edge of the 70.4 degree field of view.
TEST(Refract, ReachesFieldOfViewOfMid70) {
  std::vector<WedgePrism> prisms = {{29.7 * degree, 1.51, 0.0, 0.0, false},
                                    {29.7 * degree, 1.51, 0.0, 0.0, true}};
  EXPECT_NEAR(std::acos(refract(prisms, 0.0, Vector3d::UnitX()).x()), 35.2 * degree, 0.1 * degree);
  prisms[1].phase = std::numbers::pi;  // in opposite directions they cancel
  EXPECT_NEAR(std::acos(refract(prisms, 0.0, Vector3d::UnitX()).x()), 0.0, 1e-6);
}

// The covered fraction of a grid over the field of view increases. The second half of a second does
// not repeat the first.
TEST(ScanPattern, CoversFieldIncreasinglyWithRosette) {
  LidarConfig config;
  config.firing_period = 1e-5;
  config.prisms = {{29.7 * degree, 1.51, -77.733, 0.0, false},
                   {29.7 * degree, 1.51, 121.567, 0.0, true}};
  const ScanPattern pattern(config);
  Pulses pulses;
  std::set<std::pair<int, int>> cells;
  std::vector<std::size_t> covered;
  for (std::uint64_t block = 0; block < 3125; ++block) {
    pattern.aim(block, pulses);
    for (std::size_t slot = 0; slot < pattern.slots(); ++slot) {
      const Vector3d beam = direction(pulses, slot);
      EXPECT_LT(std::acos(beam.x()), 35.3 * degree);
      cells.insert(
          {std::lround(100 * beam.y() / beam.x()), std::lround(100 * beam.z() / beam.x())});
    }
    if ((block + 1) % 625 == 0) covered.push_back(cells.size());
  }
  const double all = std::numbers::pi * std::pow(100 * std::tan(35.2 * degree), 2);
  EXPECT_GT(static_cast<double>(covered[0]), 0.3 * all);  // 20,000 pulses on 15,600 cells
  for (std::size_t i = 1; i < covered.size(); ++i) EXPECT_GT(covered[i], covered[i - 1]) << i;
  EXPECT_GT(static_cast<double>(covered.back()), 0.9 * all);
}

TEST(LidarConfig, ReportsTheInvalidField) {
  const auto expect_error = [](auto change, const char* message) {
    LidarConfig config;
    change(config);
    try {
      config.validate();
      FAIL() << "accepted: " << message;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_config);
      EXPECT_THAT(error.what(), HasSubstr(message));
    }
  };
  expect_error([](auto& c) { c.firing_period = 0.0; }, "firing_period is 0");
  expect_error([](auto& c) { c.channels.clear(); }, "channels is 0");
  expect_error([](auto& c) { c.channels[0].elevation = 2.0; }, "channels[0].elevation is 2");
  expect_error([](auto& c) { c.channels[0].delay = 1.0; }, "channels[0].delay is 1");
  expect_error([](auto& c) { c.field_of_view = 7.0; }, "field_of_view is 7");
  expect_error([](auto& c) { c.prisms.resize(1); }, "prisms[0].wedge is 0");
  expect_error([](auto& c) { c.max_range = 0.0; }, "max_range is 0");
  expect_error([](auto& c) { c.errors.sigma = -1.0; }, "errors.sigma is -1");
  expect_error([](auto& c) { c.sensitivity.reference_reflectance = 0.0; }, "reflectance is 0");
  expect_error([](auto& c) { c.beam.rings = 9; }, "beam.rings is 9");
  expect_error([](auto& c) { c.beam.max_returns = 0; }, "beam.max_returns is 0");
}

}  // namespace
}  // namespace skycap::sim
