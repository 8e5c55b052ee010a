#include "survey/photo/photo_choice.h"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/random_numbers.h"
#include "survey/photo/cover_bound.h"
#include "tests/survey/photo/test_scenes.h"

namespace skycap::survey::photo {
namespace {

using Eigen::Vector3d;
using geometry::View;

/// Random photos and samples above a level plane. Each photo observes random samples.
struct RandomCase {
  TargetSamples samples;
  PhotoChoiceProblem problem;

  RandomCase(std::size_t photos, std::size_t count, double observed, std::uint64_t seed) {
    geometry::RandomNumbers random(seed);
    for (std::size_t s = 0; s < count; ++s) {
      samples.points.push_back(
          Vector3d{random.between(-2, 2), random.between(-2, 2), 0.0}.cast<float>());
      samples.normals.emplace_back(0, 0, 1);
      samples.triangles.push_back(0);
    }
    for (std::size_t c = 0; c < photos; ++c) {
      const Vector3d position{random.between(-5, 5), random.between(-5, 5), random.between(5, 12)};
      problem.candidates.push_back({position, -Vector3d::UnitZ()});
      for (std::uint32_t s = 0; s < count; ++s) {
        if (random.uniform() < observed) problem.observed.items.push_back(s);
      }
      problem.observed.begin.push_back(static_cast<std::uint32_t>(problem.observed.items.size()));
    }
    problem.observers = transposed(problem.observed, count);
    problem.samples = &samples;
    problem.rule.view_distance = 8.0;
  }
};

/// Returns k of a sample by its definition.
int partners_by_definition(const RandomCase& known, const std::vector<std::uint32_t>& chosen,
                           std::uint32_t sample) {
  const StereoPairs pairs(known.problem.rule);
  std::vector<Observation> seen;
  for (const std::uint32_t c : chosen) {
    const auto observed = known.problem.observed[c];
    if (std::ranges::find(observed, sample) == observed.end()) continue;
    seen.push_back(
        make_observation(known.problem.candidates[c].position, c, known.samples, sample));
  }
  return stereo_partners(seen, pairs);
}

TEST(PhotoChoice, CountsPartnersAsDefinedWhilePhotosComeAndGo) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const RandomCase known(20, 10, 0.5, seed);
    PhotoChoice choice(known.problem);
    geometry::RandomNumbers random(seed, 7);
    for (int step = 0; step < 30; ++step) {
      const auto c = static_cast<std::uint32_t>(random() % 20);
      const auto& chosen = choice.chosen();
      if (std::ranges::find(chosen, c) != chosen.end()) {
        choice.remove(c);
      } else {
        choice.add(c);
      }
    }
    std::size_t satisfied = 0;
    for (std::uint32_t s = 0; s < 10; ++s) {
      const int k = partners_by_definition(known, choice.chosen(), s);
      EXPECT_EQ(choice.partners(s), k) << seed;
      EXPECT_EQ(choice.is_satisfied(s), k >= known.problem.rule.min_partners);
      satisfied += k >= known.problem.rule.min_partners ? 1 : 0;
    }
    EXPECT_EQ(choice.satisfied(), satisfied);
  }
}

/// Returns the value of a set of photos by its definition: the sum over samples of phi + 0.3 min(1,
/// h).
double value_by_definition(const RandomCase& known, const StereoPairs& pairs,
                           const std::vector<std::uint32_t>& chosen) {
  double value = 0.0;
  for (std::uint32_t s = 0; s < known.samples.size(); ++s) {
    std::vector<Observation> seen;
    for (const std::uint32_t c : chosen) {
      const auto observed = known.problem.observed[c];
      if (std::ranges::find(observed, s) == observed.end()) continue;
      seen.push_back(make_observation(known.problem.candidates[c].position, c, known.samples, s));
    }
    if (seen.empty()) continue;
    const int k = std::max(stereo_partners(seen, pairs), 0);
    value += std::min(known.problem.rule.min_partners + 1, 1 + k) +
             0.3 * std::min(1.0, reconstructability(seen, pairs));
  }
  return value;
}

TEST(PhotoChoice, GreedyAddsThePhotoWithTheLargestGain) {
  constexpr std::uint32_t photos = 20;
  constexpr double rounding = 1e-3;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const RandomCase known(photos, 10, 0.5, seed);
    const StereoPairs pairs(known.problem.rule);
    PhotoChoice choice(known.problem);
    choice.greedy({.min_gain = rounding, .max_photos = 8});
    std::vector<std::uint32_t> taken;
    for (const std::uint32_t next : choice.chosen()) {
      std::vector<std::uint32_t> with_next = taken;
      with_next.push_back(next);
      const double value = value_by_definition(known, pairs, with_next);
      for (std::uint32_t other = 0; other < photos; ++other) {
        const auto is_same = [&](std::uint32_t c) {
          return (known.problem.candidates[c].position - known.problem.candidates[other].position)
                     .norm() < known.problem.rule.same_position();
        };
        if (std::ranges::any_of(taken, is_same)) continue;
        std::vector<std::uint32_t> with_other = taken;
        with_other.push_back(other);
        EXPECT_LE(value_by_definition(known, pairs, with_other), value + rounding) << seed;
      }
      taken = with_next;
    }
  }
}

TEST(PhotoChoice, CountsPartnersOfAnyNumberOfObservations) {
  RandomCase known(60, 5, 1.0, 3);
  for (std::size_t i = 0; i < 60; ++i) {  // All photos within 2 degrees: no partners.
    known.problem.candidates[i].position = {0.005 * static_cast<double>(i), 0.0, 10.0};
  }
  known.problem.rule.view_distance = 0.05;
  PhotoChoice choice(known.problem);
  choice.greedy({.min_gain = -1.0});
  EXPECT_EQ(choice.chosen().size(), 60U);
  for (std::size_t s = 0; s < 5; ++s) EXPECT_EQ(choice.partners(s), 0);
  choice.destroy_and_repair({20, 1});
  EXPECT_EQ(choice.chosen().size(), 60U);  // Without satisfied samples, nothing is removed.
}

TEST(PhotoChoice, NeverTakesTwoPhotosOfOnePosition) {
  RandomCase known(60, 40, 0.5, 11);
  for (std::size_t i = 30; i < 60; ++i) {  // Each photo twice, at slightly different positions.
    known.problem.candidates[i] = known.problem.candidates[i - 30];
    known.problem.candidates[i].position.x() += 0.01;
  }
  PhotoChoice choice(known.problem);
  choice.greedy({});
  choice.destroy_and_repair({100, 5});
  for (const std::uint32_t a : choice.chosen()) {
    for (const std::uint32_t b : choice.chosen()) {
      if (a == b) continue;
      EXPECT_GE(
          (known.problem.candidates[a].position - known.problem.candidates[b].position).norm(),
          known.problem.rule.same_position());
    }
  }
}

TEST(PhotoChoice, SearchKeepsSatisfactionWithNoMorePhotos) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const RandomCase known(80, 60, 0.3, seed);
    PhotoChoice choice(known.problem);
    choice.greedy({});
    const std::size_t photos = choice.chosen().size(), satisfied = choice.satisfied();
    choice.destroy_and_repair({200, seed});
    EXPECT_LE(choice.chosen().size(), photos);
    EXPECT_GE(choice.satisfied(), satisfied);
  }
}

TEST(PhotoChoice, DoesNotDependOnThreads) {
  RandomCase one(200, 600, 0.2, 3), several(200, 600, 0.2, 3);
  one.problem.threads = 1;
  several.problem.threads = 8;
  PhotoChoice a(one.problem), b(several.problem);
  for (PhotoChoice* choice : {&a, &b}) {
    choice->greedy({});
    choice->destroy_and_repair({50, 1});
  }
  EXPECT_EQ(a.chosen(), b.chosen());
}

TEST(PhotoChoice, CountsPhotosOfOnePositionOnceWhenEvaluated) {
  // Point under three photos, of which two are at the same position.
  const geometry::Mesh target = wall(4.0, 2.0, 4.0);
  const geometry::SightLines visible_targets(target, 1);
  const geometry::PhotoCamera camera(test_camera());
  TargetSamples samples;
  samples.points = {{2, 0, 4}};
  samples.normals = {{0, -1, 0}};
  samples.triangles = {0};
  StereoRule rule;
  rule.view_distance = 10.0;
  const Observer observer(camera, rule, visible_targets, samples);
  const auto view = [](double x) {
    return geometry::look_at(Vector3d(x, -10, 4), Vector3d(2, 0, 4));
  };
  const std::vector<View> photos{view(2.0), view(4.0), view(4.2)};
  const PhotoChoiceProblem once = photo_choice_problem(photos, observer, true, 1);
  PhotoChoice choice(once);
  for (std::uint32_t i = 0; i < 3; ++i) choice.add(i);
  EXPECT_EQ(choice.partners(0), 1);
  const PhotoChoiceProblem apart = photo_choice_problem(photos, observer, false, 1);
  PhotoChoice twice(apart);
  for (std::uint32_t i = 0; i < 3; ++i) twice.add(i);
  EXPECT_EQ(twice.partners(0), 2);
}

/// Returns the minimum number of photos with this number of observations of each sample, by trying
/// all sets.
std::size_t fewest_by_brute_force(const PhotoChoiceProblem& problem,
                                  const std::vector<std::uint32_t>& samples, int observations) {
  const auto photos = static_cast<unsigned>(problem.candidates.size());
  std::size_t fewest = photos + 1;
  for (std::uint32_t set = 0; set < 1U << photos; ++set) {
    const auto size = static_cast<std::size_t>(std::popcount(set));
    if (size >= fewest) continue;
    const bool covers = std::ranges::all_of(samples, [&](std::uint32_t s) {
      int seen = 0;
      for (const std::uint32_t c : problem.observers[s]) seen += (set >> c & 1U) != 0 ? 1 : 0;
      return seen >= observations;
    });
    if (covers) fewest = size;
  }
  return fewest;
}

TEST(CoverBound, IsBelowTheFewestPhotosAndNearThem) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RandomCase known(14, 12, 0.6, seed);
    std::vector<std::uint32_t> samples;
    constexpr int observations = 3;
    for (std::uint32_t s = 0; s < 12; ++s) {
      if (known.problem.observers[s].size() >= observations) samples.push_back(s);
    }
    const std::size_t fewest = fewest_by_brute_force(known.problem, samples, observations);
    const CoverBound bound = cover_bound(known.problem, samples, observations, fewest + 2);
    EXPECT_LE(bound.photos, fewest) << seed;
    EXPECT_GE(bound.photos + 2, fewest) << seed;
    EXPECT_GE(bound.relaxed, observations - 1e-6) << seed;
  }
}

}  // namespace
}  // namespace skycap::survey::photo
