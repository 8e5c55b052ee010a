#include "survey/photo/photo_choice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/parallel.h"
#include "geometry/random_numbers.h"

namespace skycap::survey::photo {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

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

/// Rule by which photos increase the value of samples.
struct GainRule {
  StereoPairs pairs;
  bool counts_h = true;  ///< True if h is part of the value.

  bool has_enough(const SampleState& state) const {
    return !state.observations.empty() && state.partners >= pairs.rule().min_partners;
  }
  /// Returns true if no photo increases the sample's value.
  bool is_full(const SampleState& state) const {
    return has_enough(state) && (!counts_h || state.h >= 1.0F);
  }
};

/// Gains of candidates at samples, kept up to date while photos are added. Gains are integers, so
/// that their sums do not depend on the order of the additions.
class GainTable {
 public:
  static constexpr std::int64_t unit = 1 << 16;  ///< Gain of a sample's first photo.

  explicit GainTable(const PhotoChoiceProblem& problem)
      : problem_(problem),
        entry_of_sample_(problem.samples->size(), none),
        slot_of_candidate_(problem.candidates.size(), none) {}

  /// Computes the gains of `candidates` at `samples`, which have these weights and are not full.
  void start(std::vector<std::uint32_t> samples, std::vector<std::int64_t> weights,
             std::vector<std::uint32_t> candidates, const std::vector<SampleState>& states,
             const GainRule& rule) {
    for (const std::uint32_t s : samples_) entry_of_sample_[s] = none;
    for (const std::uint32_t c : candidates_) slot_of_candidate_[c] = none;
    samples_ = std::move(samples);
    weights_ = std::move(weights);
    candidates_ = std::move(candidates);
    for (std::uint32_t i = 0; i < samples_.size(); ++i) entry_of_sample_[samples_[i]] = i;
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) slot_of_candidate_[candidates_[i]] = i;
    make_entries(states, rule);
  }

  const std::vector<std::uint32_t>& candidates() const { return candidates_; }
  /// Returns the weighted gains of the candidates, in their order.
  const std::vector<std::int64_t>& totals() const { return totals_; }

  /// Updates the gains at a sample after an observation was appended to its state.
  void update(std::uint32_t sample, const SampleState& state, bool was_full, const GainRule& rule) {
    const std::uint32_t i = entry_of_sample_[sample];
    if (i == none || was_full) return;
    const std::int64_t weight = weights_[i];
    const Moment now(state, rule);
    for (std::size_t e = begin_[i]; e < begin_[i + 1]; ++e) {
      Entry& entry = entries_[e];
      std::int64_t& total = totals_[entry.seen.photo];
      total -= weight * entry.gain;
      append(entry, state.observations.back().seen, state.observations.size() - 1, rule);
      entry.gain = gain(entry, now, rule);
      total += weight * entry.gain;
    }
  }

 private:
  /// Observation by a candidate. `seen.photo` is the candidate's index in the table.
  struct Entry {
    Observation seen;
    std::uint32_t partners = 0;  ///< Bit i: observation i of the sample is a stereo partner.
    float h = 0.0F;              ///< Sum of the terms of h with the sample's observations.
    std::int32_t gain = 0;
  };
  /// Number of bits of Entry::partners. Samples with more observations gain nothing.
  static constexpr std::size_t max_observations = 32;

  /// Properties of a sample's state, on which its gains depend.
  struct Moment {
    Moment(const SampleState& state, const GainRule& rule)
        : count(state.observations.size()),
          partners(state.partners),
          h(state.h),
          is_full(rule.is_full(state) || count > max_observations) {
      if (is_full) return;
      for (std::size_t i = 0; i < count; ++i) {
        if (state.observations[i].partners == partners) with_most |= 1U << i;
      }
    }
    std::size_t count;
    int partners;
    float h;
    bool is_full;
    std::uint32_t with_most = 0;  ///< Observations with the largest number of partners.
  };

  static void append(Entry& entry, const Observation& added, std::size_t index,
                     const GainRule& rule) {
    if (index < max_observations && rule.pairs.are_partners(entry.seen, added)) {
      entry.partners |= 1U << index;
    }
    if (rule.counts_h) entry.h += rule.pairs.reconstructability(entry.seen, added);
  }

  /// Returns the increase of a sample's value by a candidate.
  static std::int32_t gain(const Entry& entry, const Moment& now, const GainRule& rule) {
    if (now.is_full) return 0;
    if (now.count == 0) return static_cast<std::int32_t>(unit);
    const int enough = rule.pairs.rule().min_partners;
    const int max = std::max(std::popcount(entry.partners),
                             now.partners + ((entry.partners & now.with_most) != 0 ? 1 : 0));
    const int more = std::min(std::max(max, now.partners), enough) - std::min(now.partners, enough);
    std::int64_t value = more * unit;
    if (rule.counts_h && now.h < 1.0F) {
      constexpr float weight_of_h = 0.3F;
      const float rise = std::min(1.0F, now.h + entry.h) - now.h;
      value += std::lround(weight_of_h * rise * static_cast<float>(unit));
    }
    return static_cast<std::int32_t>(value);
  }

  void make_entries(const std::vector<SampleState>& states, const GainRule& rule) {
    begin_.assign(samples_.size() + 1, 0);
    geometry::parallel_for_each(samples_.size(), problem_.threads, [&](std::size_t i) {
      begin_[i + 1] = static_cast<std::size_t>(
          std::ranges::count_if(problem_.observers[samples_[i]],
                                [&](std::uint32_t c) { return slot_of_candidate_[c] != none; }));
    });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    entries_.resize(begin_.back());
    constexpr std::size_t block = 128;
    const std::size_t blocks = (samples_.size() + block - 1) / block;
    geometry::parallel_for(blocks, problem_.threads, [&](std::size_t number) {
      const std::size_t end = std::min(samples_.size(), (number + 1) * block);
      for (std::size_t i = number * block; i < end; ++i) {
        make_entries_of(i, states[samples_[i]], rule);
      }
    });
    totals_.assign(candidates_.size(), 0);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      for (std::size_t e = begin_[i]; e < begin_[i + 1]; ++e) {
        totals_[entries_[e].seen.photo] += weights_[i] * entries_[e].gain;
      }
    }
  }

  void make_entries_of(std::size_t i, const SampleState& state, const GainRule& rule) {
    const Moment now(state, rule);
    Entry* entry = &entries_[begin_[i]];
    for (const std::uint32_t c : problem_.observers[samples_[i]]) {
      if (slot_of_candidate_[c] == none) continue;
      *entry = {make_observation(problem_.candidates[c].position, slot_of_candidate_[c],
                                 *problem_.samples, samples_[i])};
      for (std::size_t o = 0; o < state.observations.size(); ++o) {
        append(*entry, state.observations[o].seen, o, rule);
      }
      entry->gain = gain(*entry, now, rule);
      ++entry;
    }
  }

  const PhotoChoiceProblem& problem_;
  std::vector<std::uint32_t> samples_, candidates_;
  std::vector<std::int64_t> weights_;
  std::vector<std::uint32_t> entry_of_sample_;    ///< Index in samples_, or none.
  std::vector<std::uint32_t> slot_of_candidate_;  ///< Index in candidates_, or none.
  std::vector<std::size_t> begin_;                ///< Entries of each sample.
  std::vector<Entry> entries_;
  std::vector<std::int64_t> totals_;
};

}  // namespace

struct PhotoChoice::Impl {
  explicit Impl(const PhotoChoiceProblem& given)
      : problem(given),
        rule{StereoPairs(given.rule)},
        samples(given.samples->size()),
        blocked(given.candidates.size(), 0),
        near(given.candidates.size()) {
    find_near();
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

  void count_satisfied(const SampleState& state, int sign) {
    if (rule.has_enough(state)) satisfied += static_cast<std::size_t>(sign);
  }

  /// Returns h of a sample, computed from all its observations.
  float sum_of_pairs(const SampleState& state) const {
    float h = 0.0F;
    for (std::size_t i = 0; i < state.observations.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        h += rule.pairs.reconstructability(state.observations[i].seen, state.observations[j].seen);
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
      if (rule.counts_h) state.h += rule.pairs.reconstructability(added.seen, other.seen);
      if (!rule.pairs.are_partners(added.seen, other.seen)) continue;
      ++added.partners;
      state.partners = std::max(state.partners, ++other.partners);
    }
    state.partners = std::max(state.partners, added.partners);
    state.observations.push_back(added);
    count_satisfied(state, 1);
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
      if (rule.pairs.are_partners(removed, other.seen)) --other.partners;
      state.partners = std::max(state.partners, other.partners);
    }
    if (rule.counts_h) state.h = sum_of_pairs(state);
    count_satisfied(state, 1);
  }

  void block(std::uint32_t candidate, int sign) {
    for (const std::uint32_t other : near[candidate]) blocked[other] += sign;
  }

  /// Adds a photo and updates the gains, if a table is given.
  void add(std::uint32_t candidate, GainTable* gains = nullptr) {
    for (const std::uint32_t sample : problem.observed[candidate]) {
      const bool was_full = rule.is_full(samples[sample]);
      add_to_sample(candidate, sample);
      if (gains != nullptr) gains->update(sample, samples[sample], was_full, rule);
    }
    block(candidate, 1);
    chosen.push_back(candidate);
  }

  void remove(std::uint32_t candidate) {
    for (const std::uint32_t sample : problem.observed[candidate]) {
      remove_from_sample(candidate, sample);
    }
    block(candidate, -1);
    std::erase(chosen, candidate);
  }

  /// Adds photos of the table with the largest gains, multiplied by the factors of the table's
  /// candidates, while `may_go_on()` returns true and the gains exceed `min_gain`.
  template <typename GoesOn>
  void fill(GainTable& gains, std::span<const float> factors, double min_gain, GoesOn may_go_on,
            const std::function<void()>& added) {
    while (may_go_on()) {
      double best = min_gain;
      std::uint32_t choice = none;
      for (std::uint32_t i = 0; i < gains.totals().size(); ++i) {
        const std::uint32_t c = gains.candidates()[i];
        const auto total = static_cast<double>(gains.totals()[i]);
        const double value = factors.empty() ? total : total * factors[i];
        if (blocked[c] == 0 && value > best) best = value, choice = c;
      }
      if (choice == none) return;
      add(choice, &gains);
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

  /// Work space of the search.
  struct Search {
    explicit Search(const PhotoChoiceProblem& problem)
        : gains(problem), last_round(problem.samples->size(), none) {}
    GainTable gains;
    std::vector<std::uint32_t> last_round;  ///< Last round that changed each sample.
    std::uint32_t round = 0;
    std::size_t enough = 0;  ///< Number of satisfied samples to be kept.
  };
  /// Samples of removed photos that are not satisfied.
  struct Lack {
    std::vector<std::uint32_t> samples;
    std::vector<std::int64_t> weights;
  };

  Lack remove_all(std::span<const std::uint32_t> photos, Search& search);
  std::vector<std::uint32_t> promising(const Lack& lack, std::size_t photos) const;
  void repair_once(geometry::RandomNumbers& random, Search& search);

  const PhotoChoiceProblem& problem;
  GainRule rule;
  std::vector<SampleState> samples;
  std::vector<int> blocked;  ///< Number of selected photos at the same position.
  std::vector<std::vector<std::uint32_t>> near;  ///< Candidates at the same position.
  std::vector<std::uint32_t> chosen;
  std::size_t satisfied = 0;
};

PhotoChoice::Impl::Lack PhotoChoice::Impl::remove_all(std::span<const std::uint32_t> photos,
                                                      Search& search) {
  // Other samples are ignored: they change little, but would increase the computing time.
  std::vector<std::uint32_t> touched;
  std::vector<char> was_satisfied;
  for (const std::uint32_t c : photos) {
    for (const std::uint32_t s : problem.observed[c]) {
      if (search.last_round[s] == search.round) continue;
      search.last_round[s] = search.round;
      touched.push_back(s);
      was_satisfied.push_back(rule.has_enough(samples[s]) ? 1 : 0);
    }
  }
  for (const std::uint32_t c : photos) remove(c);
  constexpr std::int64_t weight_of_lost = 20, weight_of_others = 3;
  Lack lack;
  for (std::size_t i = 0; i < touched.size(); ++i) {
    if (rule.has_enough(samples[touched[i]])) continue;
    lack.samples.push_back(touched[i]);
    lack.weights.push_back(was_satisfied[i] != 0 ? weight_of_lost : weight_of_others);
  }
  return lack;
}

/// Returns the candidates that observe the largest weight of these samples, in ascending order.
/// `photos` is the size of the plan.
std::vector<std::uint32_t> PhotoChoice::Impl::promising(const Lack& lack,
                                                        std::size_t photos) const {
  constexpr std::size_t few_photos = 50, few_candidates = 200, many_candidates = 400;
  const std::size_t max_candidates = photos < few_photos ? few_candidates : many_candidates;
  std::vector<std::int64_t> weight(problem.candidates.size(), 0);
  for (std::size_t i = 0; i < lack.samples.size(); ++i) {
    for (const std::uint32_t c : problem.observers[lack.samples[i]]) weight[c] += lack.weights[i];
  }
  std::vector<std::uint32_t> result;
  for (std::uint32_t c = 0; c < weight.size(); ++c) {
    if (weight[c] > 0 && blocked[c] == 0) result.push_back(c);
  }
  if (result.size() > max_candidates) {
    const auto end = result.begin() + static_cast<std::ptrdiff_t>(max_candidates);
    std::ranges::nth_element(result, end, [&](std::uint32_t a, std::uint32_t b) {
      return weight[a] != weight[b] ? weight[a] > weight[b] : a < b;
    });
    result.erase(end, result.end());
    std::ranges::sort(result);
  }
  return result;
}

void PhotoChoice::Impl::repair_once(geometry::RandomNumbers& random, Search& search) {
  constexpr double min_share = 0.06, max_share = 0.18, noise = 0.15;
  constexpr std::size_t max_neighbours = 200;  // Larger clusters of large plans do not help.
  const std::size_t before = chosen.size();
  const std::uint32_t centre = chosen[random() % before];
  const double share = random.between(min_share, max_share);
  const auto count = static_cast<std::size_t>(
      std::max(1.0, std::round(share * static_cast<double>(std::min(before, max_neighbours)))));
  geometry::ShortRandomNumbers draws(random());

  ++search.round;
  const std::vector<std::uint32_t> removed = neighbourhood(centre, count);
  Lack lack = remove_all(removed, search);
  std::vector<std::uint32_t> candidates = promising(lack, before);
  std::vector<float> factors(candidates.size());
  for (float& factor : factors) factor = static_cast<float>(1.0 + noise * draws.uniform());
  search.gains.start(std::move(lack.samples), std::move(lack.weights), std::move(candidates),
                     samples, rule);
  fill(search.gains, factors, 0.0,
       [&] { return satisfied < search.enough && chosen.size() < before; }, {});
  if (satisfied >= search.enough) return;
  const std::vector<std::uint32_t> refilled(
      chosen.begin() + static_cast<std::ptrdiff_t>(before - removed.size()), chosen.end());
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
  return impl_->rule.has_enough(impl_->samples[sample]);
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
  std::vector<std::uint32_t> samples, candidates(impl_->problem.candidates.size());
  for (std::uint32_t s = 0; s < impl_->samples.size(); ++s) {
    if (!impl_->rule.is_full(impl_->samples[s])) samples.push_back(s);
  }
  std::iota(candidates.begin(), candidates.end(), 0U);
  std::vector<std::int64_t> weights(samples.size(), 1);
  GainTable gains(impl_->problem);
  gains.start(std::move(samples), std::move(weights), std::move(candidates), impl_->samples,
              impl_->rule);
  impl_->fill(
      gains, {}, limits.min_gain * static_cast<double>(GainTable::unit),
      [&] {
        return impl_->chosen.size() < limits.max_photos &&
               impl_->satisfied < limits.enough_satisfied;
      },
      added);
}

void PhotoChoice::destroy_and_repair(const Repair& options, const std::stop_token& stop) {
  geometry::RandomNumbers random(options.seed, 2);
  if (impl_->satisfied == 0) return;  // Any photo could be removed.
  Impl::Search search(impl_->problem);
  search.enough = impl_->satisfied;
  impl_->rule.counts_h = false;
  for (std::size_t round = 0; round < options.rounds && !stop.stop_requested(); ++round) {
    if (impl_->chosen.empty()) break;
    impl_->repair_once(random, search);
  }
  impl_->rule.counts_h = true;
  geometry::parallel_for_each(impl_->samples.size(), impl_->problem.threads, [&](std::size_t s) {
    impl_->samples[s].h = impl_->sum_of_pairs(impl_->samples[s]);
  });
}

}  // namespace skycap::survey::photo
