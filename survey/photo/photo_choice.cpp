#include "survey/photo/photo_choice.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/parallel.h"
#include "geometry/random_numbers.h"

namespace skycap::survey::photo {
namespace {

/// Observation by a selected photo, with its number of stereo partners.
struct Partnered {
  Observation seen;
  int partners = 0;
};

/// State of a sample under the selected photos.
struct SampleState {
  std::vector<Partnered> observations;
  int partners = 0;  ///< Maximum over the observations.
  float h = 0.0F;
};

constexpr float weight_of_h = 0.3F;

/// Samples processed in one task of a thread.
constexpr std::size_t samples_in_block = 32;

}  // namespace

struct PhotoChoice::Impl {
  explicit Impl(const PhotoChoiceProblem& given)
      : problem(given),
        pairs(given.rule),
        samples(given.samples->size()),
        gains(given.observers.items.size(), 0.0F),
        is_current(given.samples->size(), 0),
        seen(given.observers.items.size()),
        is_open(given.candidates.size(), 1),
        blocked(given.candidates.size(), 0),
        is_chosen(given.candidates.size(), 0),
        near(given.candidates.size()) {
    find_near();
    geometry::parallel_for_each(samples.size(), problem.threads, [&](std::size_t s) {
      std::uint32_t entry = problem.observers.begin[s];
      for (const std::uint32_t c : problem.observers[s]) {
        seen[entry++] = make_observation(problem.candidates[c].position, c, *problem.samples, s);
      }
    });
  }

  void find_near() {
    const double distance = problem.rule.same_position();
    geometry::parallel_for(near.size(), problem.threads, [&](std::size_t i) {
      for (std::uint32_t j = 0; j < near.size(); ++j) {
        const auto between = problem.candidates[i].position - problem.candidates[j].position;
        if (between.squaredNorm() < distance * distance) near[i].push_back(j);
      }
    });
  }

  /// Returns true if no photo increases the sample's value.
  bool is_full(const SampleState& state) const {
    return !state.observations.empty() && state.partners >= problem.rule.min_partners &&
           (!counts_h || state.h >= 1.0F);
  }

  /// Returns the increase of a sample's value by an observation.
  float gain(const Observation& added, const SampleState& state) const {
    const int enough = problem.rule.min_partners;
    if (state.observations.empty()) return 1.0F;
    int own = 0, max = state.partners;
    for (const Partnered& other : state.observations) {
      if (!pairs.are_partners(added, other.seen)) continue;
      ++own;
      max = std::max(max, other.partners + 1);
    }
    const int more = std::min(std::max(max, own), enough) - std::min(state.partners, enough);
    if (!counts_h || state.h >= 1.0F) return static_cast<float>(more);
    float h = 0.0F;
    for (const Partnered& other : state.observations) {
      h += pairs.reconstructability(added, other.seen);
    }
    return static_cast<float>(more) + weight_of_h * (std::min(1.0F, state.h + h) - state.h);
  }

  void count_satisfied(const SampleState& state, int sign) {
    const bool is = !state.observations.empty() && state.partners >= problem.rule.min_partners;
    if (is) satisfied += static_cast<std::size_t>(sign);
  }

  /// Returns h of a sample, computed from all its observations.
  float sum_of_pairs(const SampleState& state) const {
    float h = 0.0F;
    for (std::size_t i = 0; i < state.observations.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        h += pairs.reconstructability(state.observations[i].seen, state.observations[j].seen);
      }
    }
    return h;
  }

  void add_to_sample(std::uint32_t candidate, std::size_t sample) {
    SampleState& state = samples[sample];
    count_satisfied(state, -1);
    Partnered added{make_observation(problem.candidates[candidate].position, candidate,
                                     *problem.samples, sample)};
    for (Partnered& other : state.observations) {
      if (counts_h) state.h += pairs.reconstructability(added.seen, other.seen);
      if (!pairs.are_partners(added.seen, other.seen)) continue;
      ++added.partners;
      state.partners = std::max(state.partners, ++other.partners);
    }
    state.partners = std::max(state.partners, added.partners);
    state.observations.push_back(added);
    count_satisfied(state, 1);
    is_current[sample] = 0;
  }

  void remove_from_sample(std::uint32_t candidate, std::size_t sample) {
    SampleState& state = samples[sample];
    count_satisfied(state, -1);
    const auto at = std::ranges::find_if(
        state.observations, [&](const Partnered& p) { return p.seen.photo == candidate; });
    const Observation removed = at->seen;
    state.observations.erase(at);
    state.partners = 0;
    for (Partnered& other : state.observations) {
      if (pairs.are_partners(removed, other.seen)) --other.partners;
      state.partners = std::max(state.partners, other.partners);
    }
    if (counts_h) state.h = sum_of_pairs(state);
    count_satisfied(state, 1);
    is_current[sample] = 0;
  }

  void block(std::uint32_t candidate, int sign) {
    for (const std::uint32_t other : near[candidate]) blocked[other] += sign;
  }

  void add(std::uint32_t candidate) {
    for (const std::uint32_t sample : problem.observed[candidate]) add_to_sample(candidate, sample);
    block(candidate, 1);
    is_chosen[candidate] = 1;
    chosen.push_back(candidate);
  }

  void remove(std::uint32_t candidate) {
    for (const std::uint32_t sample : problem.observed[candidate]) {
      remove_from_sample(candidate, sample);
    }
    block(candidate, -1);
    is_chosen[candidate] = 0;
    std::erase(chosen, candidate);
  }

  /// Updates the gains of these samples.
  void update_gains(std::span<const std::uint32_t> which) {
    const std::size_t blocks = (which.size() + samples_in_block - 1) / samples_in_block;
    const auto update = [&](std::size_t number) {
      const std::size_t end = std::min(which.size(), (number + 1) * samples_in_block);
      for (std::size_t i = number * samples_in_block; i < end; ++i) {
        const std::uint32_t sample = which[i];
        if (is_current[sample] != 0) continue;
        const std::uint32_t first = problem.observers.begin[sample];
        const auto candidates = problem.observers[sample];
        const bool full = is_full(samples[sample]);
        for (std::size_t k = 0; k < candidates.size(); ++k) {
          const std::uint32_t c = candidates[k];
          if (is_open[c] == 0) continue;
          gains[first + k] =
              full || is_chosen[c] != 0 ? 0.0F : gain(seen[first + k], samples[sample]);
        }
        is_current[sample] = 1;
      }
    };
    constexpr std::size_t worth_threads = 4;
    if (blocks < worth_threads) {
      for (std::size_t number = 0; number < blocks; ++number) update(number);
    } else {
      geometry::parallel_for(blocks, problem.threads, update);
    }
  }

  /// Adds a sample's weighted gains to the totals of its candidates, or subtracts them.
  void sum_gains(std::uint32_t sample, double weight) {
    const std::uint32_t first = problem.observers.begin[sample];
    const auto candidates = problem.observers[sample];
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const std::uint32_t c = candidates[k];
      if (is_open[c] != 0) totals[c] += weight * gains[first + k];
    }
  }

  /// Restricts the candidates to the `kept` ones with the largest total.
  void keep_best(std::span<const float> factors, std::size_t kept) {
    if (kept >= totals.size()) return;
    std::vector<std::uint32_t> order(totals.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto value = [&](std::uint32_t c) {
      return blocked[c] == 0 ? totals[c] * factors[c] : -1.0;
    };
    const auto is_better = [&](std::uint32_t a, std::uint32_t b) {
      return value(a) != value(b) ? value(a) > value(b) : a < b;
    };
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(kept);
    std::ranges::nth_element(order, end, is_better);
    is_open.assign(totals.size(), 0);
    for (auto c = order.begin(); c != end; ++c) is_open[*c] = 1;
  }

  /// Adds photos with the largest totals, multiplied by the factors of their candidates, while
  /// `may_go_on()` returns true. Samples are weighted. Only the `kept` candidates with the largest
  /// initial total are considered.
  template <typename GoesOn>
  void fill(std::span<const float> weights, std::span<const float> factors, std::size_t kept,
            double min_gain, GoesOn may_go_on, const std::function<void()>& added) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t s = 0; s < samples.size(); ++s) {
      if (weights[s] > 0.0F && !is_full(samples[s])) all.push_back(s);
    }
    update_gains(all);
    totals.assign(problem.candidates.size(), 0.0);
    for (const std::uint32_t s : all) sum_gains(s, weights[s]);
    keep_best(factors, kept);
    std::vector<std::uint32_t> changed;
    while (may_go_on()) {
      double best = min_gain;
      std::uint32_t choice = std::numeric_limits<std::uint32_t>::max();
      for (std::uint32_t c = 0; c < totals.size(); ++c) {
        const double value = factors.empty() ? totals[c] : totals[c] * factors[c];
        if (blocked[c] == 0 && is_open[c] != 0 && value > best) best = value, choice = c;
      }
      if (choice == std::numeric_limits<std::uint32_t>::max()) return;
      changed.clear();
      for (const std::uint32_t s : problem.observed[choice]) {
        if (weights[s] <= 0.0F || is_full(samples[s])) continue;
        changed.push_back(s);
        sum_gains(s, -static_cast<double>(weights[s]));
      }
      add(choice);
      update_gains(changed);
      for (const std::uint32_t s : changed) sum_gains(s, weights[s]);
      if (added) added();
    }
  }

  /// Returns the photos closest to one of them in position and direction, starting with that one.
  std::vector<std::uint32_t> neighbourhood(std::uint32_t centre, std::size_t count) const {
    const geometry::View& middle = problem.candidates[centre];
    std::vector<std::pair<double, std::uint32_t>> by_distance;
    for (const std::uint32_t c : chosen) {
      const geometry::View& view = problem.candidates[c];
      by_distance.emplace_back(
          (view.position - middle.position).norm() +
              0.5 * problem.rule.view_distance * (view.direction - middle.direction).norm(),
          c);
    }
    std::ranges::sort(by_distance);
    std::vector<std::uint32_t> result;
    for (std::size_t i = 0; i < std::min(count, by_distance.size()); ++i) {
      result.push_back(by_distance[i].second);
    }
    return result;
  }

  void repair_once(geometry::RandomNumbers& random, std::size_t enough);

  const PhotoChoiceProblem& problem;
  StereoPairs pairs;
  std::vector<SampleState> samples;
  std::vector<float> gains;       ///< Gain of each entry of problem.observers.
  std::vector<char> is_current;   ///< 1 if a sample's gains are current.
  std::vector<Observation> seen;  ///< Observation of each entry of problem.observers.
  std::vector<char> is_open;      ///< Candidates under consideration.
  bool counts_h = true;           ///< True while h is part of the value.
  std::vector<double> totals;     ///< Weighted gain of each candidate.
  std::vector<int> blocked;       ///< Number of selected photos at the same position.
  std::vector<char> is_chosen;
  std::vector<std::vector<std::uint32_t>> near;  ///< Candidates at the same position.
  std::vector<std::uint32_t> chosen;
  std::size_t satisfied = 0;
};

void PhotoChoice::Impl::repair_once(geometry::RandomNumbers& random, std::size_t enough) {
  constexpr double min_share = 0.06, max_share = 0.18, weight_of_others = 0.15, noise = 0.15;
  constexpr std::size_t kept_candidates = 300;
  const std::vector<std::uint32_t> before = chosen;
  const std::uint32_t centre = chosen[random() % chosen.size()];
  const double share = random.between(min_share, max_share);
  const auto count = static_cast<std::size_t>(
      std::max(1.0, std::round(share * static_cast<double>(chosen.size()))));
  const std::uint64_t noise_seed = random();

  const std::vector<std::uint32_t> removed = neighbourhood(centre, count);
  // Samples that no removed photo observes change little, but would increase the computing time.
  std::vector<float> weights(samples.size(), 0.0F);
  std::vector<std::uint32_t> touched;
  for (const std::uint32_t c : removed) {
    for (const std::uint32_t s : problem.observed[c]) touched.push_back(s);
  }
  std::ranges::sort(touched);
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  std::vector<char> was_satisfied(touched.size());
  const auto has_enough = [&](std::uint32_t s) {
    return !samples[s].observations.empty() && samples[s].partners >= problem.rule.min_partners;
  };
  for (std::size_t i = 0; i < touched.size(); ++i) was_satisfied[i] = has_enough(touched[i]);
  for (const std::uint32_t c : removed) remove(c);
  for (std::size_t i = 0; i < touched.size(); ++i) {
    const bool is_lost = was_satisfied[i] != 0 && !has_enough(touched[i]);
    weights[touched[i]] = is_lost ? 1.0F : static_cast<float>(weight_of_others);
  }
  geometry::RandomNumbers draws(noise_seed);
  std::vector<float> factors(problem.candidates.size());
  for (float& factor : factors) factor = static_cast<float>(1.0 + noise * draws.uniform());
  std::ranges::fill(is_open, 1);
  is_current.assign(samples.size(), 0);  // Gains exist only for the candidates considered before.
  fill(weights, factors, kept_candidates, 1e-6,
       [&] { return satisfied < enough && chosen.size() < before.size(); }, {});
  if (satisfied >= enough && chosen.size() <= before.size()) return;
  std::vector<std::uint32_t> refilled(
      chosen.begin() + static_cast<std::ptrdiff_t>(before.size() - removed.size()), chosen.end());
  for (const std::uint32_t c : refilled) remove(c);
  for (const std::uint32_t c : removed) add(c);
}

PhotoChoiceProblem photo_choice_problem(std::vector<geometry::View> photos,
                                        const Observer& observer, bool one_each, unsigned threads) {
  PhotoChoiceProblem problem;
  problem.samples = &observer.samples();
  problem.rule = observer.rule();
  problem.threads = threads;
  problem.observed = observed_samples(observer, photos, threads);
  if (one_each) {
    std::vector<Eigen::Vector3d> positions;
    for (const geometry::View& photo : photos) positions.push_back(photo.position);
    const std::vector<std::uint32_t> same = same_positions(positions, problem.rule.same_position());
    std::vector<std::vector<std::uint32_t>> seen(
        photos.size());  // Samples seen by all photos at a position.
    IndexLists distinct;
    for (std::uint32_t i = 0; i < photos.size(); ++i) {
      const auto all = problem.observed[i];
      std::vector<std::uint32_t>& known = seen[same[i]];
      std::ranges::set_difference(all, known, std::back_inserter(distinct.items));
      distinct.begin.push_back(static_cast<std::uint32_t>(distinct.items.size()));
      std::vector<std::uint32_t> joint;
      std::ranges::set_union(all, known, std::back_inserter(joint));
      known.swap(joint);
    }
    problem.observed = std::move(distinct);
  }
  problem.candidates = std::move(photos);
  problem.observers = transposed(problem.observed, problem.samples->size());
  return problem;
}

PhotoChoiceProblem with_candidates(const PhotoChoiceProblem& problem,
                                   std::span<const std::uint32_t> candidates) {
  PhotoChoiceProblem part;
  part.samples = problem.samples;
  part.rule = problem.rule;
  part.threads = problem.threads;
  for (const std::uint32_t c : candidates) {
    part.candidates.push_back(problem.candidates[c]);
    const auto observed = problem.observed[c];
    part.observed.items.insert(part.observed.items.end(), observed.begin(), observed.end());
    part.observed.begin.push_back(static_cast<std::uint32_t>(part.observed.items.size()));
  }
  part.observers = transposed(part.observed, part.samples->size());
  return part;
}

PhotoChoice::PhotoChoice(const PhotoChoiceProblem& problem)
    : impl_(std::make_unique<Impl>(problem)) {}
PhotoChoice::PhotoChoice(PhotoChoice&&) noexcept = default;
PhotoChoice& PhotoChoice::operator=(PhotoChoice&&) noexcept = default;
PhotoChoice::~PhotoChoice() = default;

void PhotoChoice::add(std::uint32_t candidate) { impl_->add(candidate); }
void PhotoChoice::remove(std::uint32_t candidate) { impl_->remove(candidate); }
const std::vector<std::uint32_t>& PhotoChoice::chosen() const { return impl_->chosen; }
std::size_t PhotoChoice::satisfied() const { return impl_->satisfied; }

bool PhotoChoice::is_satisfied(std::size_t sample) const {
  const SampleState& state = impl_->samples[sample];
  return !state.observations.empty() && state.partners >= impl_->problem.rule.min_partners;
}

int PhotoChoice::partners(std::size_t sample) const {
  const SampleState& state = impl_->samples[sample];
  if (state.observations.empty()) return -2;
  return state.observations.size() == 1 ? -1 : state.partners;
}

double PhotoChoice::reconstructability(std::size_t sample) const {
  return impl_->samples[sample].h;
}

void PhotoChoice::greedy(const Limits& limits, const std::function<void()>& added) {
  const std::vector<float> weights(impl_->samples.size(), 1.0F);
  const std::size_t problem_size = impl_->problem.candidates.size();
  impl_->fill(
      weights, {}, problem_size, limits.min_gain,
      [&] {
        return impl_->chosen.size() < limits.max_photos &&
               impl_->satisfied < limits.enough_satisfied;
      },
      added);
}

void PhotoChoice::destroy_and_repair(const Repair& options, const std::stop_token& stop) {
  geometry::RandomNumbers random(options.seed, 2);
  impl_->counts_h = false;
  const std::size_t enough = impl_->satisfied;
  for (std::size_t round = 0; round < options.rounds && !stop.stop_requested(); ++round) {
    if (impl_->chosen.empty()) break;
    impl_->repair_once(random, enough);
  }
  impl_->counts_h = true;
  geometry::parallel_for_each(impl_->samples.size(), impl_->problem.threads, [&](std::size_t s) {
    impl_->samples[s].h = impl_->sum_of_pairs(impl_->samples[s]);
  });
  std::ranges::fill(impl_->is_open, 1);
  std::ranges::fill(impl_->is_current, 0);
}

CoverBound cover_bound(const PhotoChoiceProblem& problem, std::span<const std::uint32_t> samples,
                       int observations, std::size_t upper_bound) {
  constexpr int rounds = 2000, patience = 40;
  const std::size_t candidates = problem.candidates.size();
  double max = 0.0;
  for (const std::uint32_t s : samples) {
    max = std::max(max, static_cast<double>(problem.observers[s].size()));
  }
  if (max == 0.0) return {};
  std::vector<double> prices(samples.size(), 1.0 / max), reduced(candidates), slack(samples.size());
  double best = 0.0, step = 1.0;
  int idle = 0;
  for (int round = 0; round < rounds; ++round) {
    reduced.assign(candidates, 1.0);
    double bound = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      bound += observations * prices[i];
      if (prices[i] == 0.0) continue;
      for (const std::uint32_t c : problem.observers[samples[i]]) reduced[c] -= prices[i];
    }
    for (const double cost : reduced) bound += std::min(0.0, cost);
    if (bound > best + 1e-5 * best) {
      best = bound;
      idle = 0;
    } else {
      best = std::max(best, bound);
      if (++idle >= patience) step *= 0.5, idle = 0;
    }
    double squared = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      int taken = 0;
      for (const std::uint32_t c : problem.observers[samples[i]]) taken += reduced[c] < 0.0 ? 1 : 0;
      slack[i] = observations - taken;
      if (prices[i] == 0.0 && slack[i] < 0.0) slack[i] = 0.0;
      squared += slack[i] * slack[i];
    }
    if (squared == 0.0) break;
    const double length = step * (static_cast<double>(upper_bound) - bound) / squared;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      prices[i] = std::max(0.0, prices[i] + length * slack[i]);
    }
  }
  constexpr double rounding = 1e-6;
  return {best, static_cast<std::size_t>(std::ceil(best - rounding))};
}

}  // namespace skycap::survey::photo
