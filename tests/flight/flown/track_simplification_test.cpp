// Simplification of tracks: the bound holds for each sample, and what must remain remains.
#include "flight/flown/track_simplification.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<TrackSample> make_samples(const std::vector<Vector3d>& positions) {
  std::vector<TrackSample> samples;
  for (const Vector3d& position : positions) {
    samples.push_back({0.1 * static_cast<double>(samples.size()), position});
  }
  return samples;
}

/// Returns samples along a polyline, at most 0.2 m apart.
std::vector<Vector3d> sample_polyline(const std::vector<Vector3d>& corners) {
  std::vector<Vector3d> positions{corners.front()};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Vector3d leg = corners[i] - corners[i - 1];
    const int count = static_cast<int>(std::ceil(leg.norm() / 0.2));
    for (int k = 1; k <= count; ++k) positions.emplace_back(corners[i - 1] + leg * k / count);
  }
  return positions;
}

/// Returns the largest distance of a sample from the segment between the kept samples around it,
/// found by a dense search along the segment.
double searched_deviation(const std::vector<TrackSample>& samples,
                          const std::vector<std::size_t>& kept) {
  constexpr int steps = 4000;
  double largest = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::size_t after = 0;
    while (after + 1 < kept.size() && kept[after] < i) ++after;
    const Vector3d& to = samples[kept[after]].position;
    const Vector3d& from = samples[kept[after > 0 ? after - 1 : 0]].position;
    double nearest = 1e9;
    for (int k = 0; k <= steps; ++k) {
      const Vector3d on_segment = from + (to - from) * k / steps;
      nearest = std::min(nearest, (on_segment - samples[i].position).norm());
    }
    largest = std::max(largest, nearest);
  }
  return largest;
}

TEST(TrackSimplification, KeepsOnlyTheCornersOfAPolyline) {
  const std::vector<Vector3d> corners{
      {0, 0, 10}, {20, 0, 10}, {20, 20, 10}, {0, 20, 15}, {0, 0, 10}};
  const std::vector<TrackSample> samples = make_samples(sample_polyline(corners));
  const SimplifiedTrack track = simplify_track(samples, {.tolerance = 0.3});
  ASSERT_EQ(track.kept.size(), corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_LT((samples[track.kept[i]].position - corners[i]).norm(), 1e-9);
  }
  EXPECT_LT(track.deviation, 1e-6);
}

TEST(TrackSimplification, KeepsEverySampleWithinTheTolerance) {
  std::mt19937_64 random(52);
  std::normal_distribution<double> step(0.0, 0.3);
  std::uniform_real_distribution<double> size(0.05, 3.0);
  std::size_t kept = 0, all = 0;
  for (int round = 0; round < 40; ++round) {
    std::vector<Vector3d> positions{{0, 0, 20}};
    Vector3d velocity(0.5, 0.0, 0.0);
    for (int i = 0; i < 200; ++i) {
      // Smooth curves, with rests in between.
      if (i % 50 > 40) {
        positions.push_back(positions.back());
        continue;
      }
      for (int axis = 0; axis < 3; ++axis) velocity[axis] += 0.3 * step(random);
      positions.emplace_back(positions.back() + velocity);
    }
    const double tolerance = size(random);
    const std::vector<TrackSample> samples = make_samples(positions);
    const SimplifiedTrack track = simplify_track(samples, {.tolerance = tolerance});
    EXPECT_LE(track.deviation, tolerance);
    const double searched = searched_deviation(samples, track.kept);
    EXPECT_LE(searched, tolerance + 1e-3);
    EXPECT_NEAR(track.deviation, searched, 0.02);
    kept += track.kept.size(), all += samples.size();
  }
  EXPECT_LT(4 * kept, all);  // It does simplify.
}

TEST(TrackSimplification, MeasuresTheDistanceToTheSegmentBeyondItsEnds) {
  // The track overshoots its end on the same line and comes back.
  const std::vector<TrackSample> samples =
      make_samples(sample_polyline({{0, 0, 5}, {12, 0, 5}, {10, 0, 5}}));
  const SimplifiedTrack track = simplify_track(samples, {.tolerance = 0.5});
  ASSERT_EQ(track.kept.size(), 3U);
  EXPECT_LT((samples[track.kept[1]].position - Vector3d(12, 0, 5)).norm(), 1e-9);
}

TEST(TrackSimplification, KeepsCapturesAndTurnsOfTheCamera) {
  std::vector<TrackSample> samples = make_samples(sample_polyline({{0, 0, 10}, {40, 0, 10}}));
  samples[70].is_kept = true;
  EXPECT_THAT(simplify_track(samples, {}).kept, ElementsAre(0, 70, samples.size() - 1));

  samples[70].is_kept = false;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].yaw_deg = i < 100 ? 350.0 : 80.0;  // a sudden turn by 90 degrees
    samples[i].pitch_deg = -30.0;
  }
  const std::vector<std::size_t> kept = simplify_track(samples, {}).kept;
  EXPECT_THAT(kept, ElementsAre(0, 99, 100, samples.size() - 1));

  // An even rotation needs no waypoint, also past north.
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].yaw_deg = std::fmod(300.0 + 0.5 * static_cast<double>(i), 360.0);
  }
  EXPECT_EQ(simplify_track(samples, {}).kept.size(), 2U);
}

TEST(TrackSimplification, OmitsWaypointsThatCoincide) {
  std::vector<Vector3d> positions = sample_polyline({{0, 0, 10}, {10, 0, 10}});
  for (int i = 0; i < 30; ++i) positions.push_back(positions.back());
  for (const Vector3d& position : sample_polyline({{10, 0, 10}, {10, 10, 10}})) {
    positions.push_back(position);
  }
  const std::vector<TrackSample> samples = make_samples(positions);
  const SimplifiedTrack track = simplify_track(samples, {.tolerance = 0.5});
  EXPECT_EQ(track.kept.size(), 3U);
  EXPECT_LE(track.deviation, 0.5);
  EXPECT_EQ(simplify_track(make_samples({{1, 1, 1}, {1, 1, 1}}), {}).kept.size(), 1U);
}

TEST(TrackSimplification, HandlesShortTracks) {
  EXPECT_TRUE(simplify_track({}, {}).kept.empty());
  EXPECT_THAT(simplify_track(make_samples({{1, 2, 3}}), {}).kept, ElementsAre(0));
}

TEST(TrackSimplification, RejectsInvalidTolerances) {
  for (const double tolerance :
       {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(testing_support::thrown_message([&] {
                  simplify_track(make_samples({{1, 2, 3}}), {.tolerance = tolerance});
                }),
                HasSubstr("must be positive"));
  }
}

}  // namespace
}  // namespace skycap::flight
