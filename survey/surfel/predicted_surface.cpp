#include "survey/surfel/predicted_surface.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/parallel.h"

namespace skycap::survey::surfel {
namespace {

using Eigen::Vector3f;

constexpr int max_steps = 5;
constexpr float stretch = 3.0F;  // sampled length of the path before a patch, in units of the scale
constexpr double prior_strength = 40.0;  // weight of the initial rates, in patches
constexpr double max_evidence = 60.0;
constexpr double correlation = 0.2;      // neighbouring patches are correlated: five count as one
constexpr float disappointment = 0.35F;  // trust factor for a place that remained unknown

// Initial rates [continuation][step], tuned on three objects. They are only a start for learning.
constexpr std::array<std::array<double, max_steps>, continuations> first_rates = {
    {{0.8, 0.7, 0.6, 0.5, 0.4},
     {0.5, 0.4, 0.3, 0.2, 0.15},
     {0.4, 0.3, 0.2, 0.15, 0.1},
     {0.5, 0.4, 0.3, 0.2, 0.2},
     {0.9, 0.85, 0.8, 0.7, 0.6}}};

/// Initial rate of the prior surface. A few scans that do not show it reduce the rate
/// substantially.
constexpr double first_prior_rate = 0.9;

/// Minimum rate at which the prior surface replaces other predictions.
constexpr double trusted_prior_rate = 0.5;

/// Identifiers of continuations have 63 bits; patches of the prior surface are numbered with this
/// bit set.
constexpr std::uint64_t prior_key = std::uint64_t{1} << 63;

std::uint8_t rate_index(Continuation continuation, int step) {
  return static_cast<std::uint8_t>(continuations * step + static_cast<int>(continuation));
}

/// Returns the index of a chain of a surfel; `beyond` shares the chain of `straight`.
std::size_t chain_number(int direction, Continuation continuation) {
  return 4 * static_cast<std::size_t>(direction) + static_cast<std::size_t>(continuation);
}

std::uint64_t patch_key(const Vector3f& position, const Vector3f& normal, float edge, int step) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const std::uint64_t facing = static_cast<std::uint64_t>(2 * axis + (normal[axis] < 0.0F ? 1 : 0));
  // 19 bits per coordinate, 3 for the orientation, 3 for the step. Identifiers are unique within
  // 262,000 cells of the origin. Beyond that, distant places share identifiers, which has little
  // effect.
  constexpr std::uint64_t mask = (1U << 19) - 1U;
  const Eigen::Vector3i cell = (position / edge).array().floor().cast<int>();
  std::uint64_t key = facing * 8U + static_cast<std::uint64_t>(step);
  for (const int coordinate : {cell.x(), cell.y(), cell.z()}) {
    key = key << 19 | (static_cast<std::uint64_t>(coordinate) & mask);
  }
  return key;
}

}  // namespace

PredictedSurface::PredictedSurface(const PredictedSurfaceSettings& settings) : settings_(settings) {
  settings_.steps = std::clamp(settings.steps, 0, max_steps);
  for (int continuation = 0; continuation < continuations; ++continuation) {
    for (int step = 0; step < max_steps; ++step) {
      const double rate = first_rates[continuation][step];
      rates_[continuations * step + continuation] = {rate * prior_strength, prior_strength};
    }
  }
  rates_[prior_kind] = {first_prior_rate * prior_strength, prior_strength};
}

double PredictedSurface::hit_rate(Continuation continuation, int step) const {
  const Rate& rate = rates_[rate_index(continuation, step)];
  return rate.hits / rate.tries;
}

void PredictedSurface::predict(const SurfelMap& map, const FreeSpaceHistory& space,
                               const std::optional<Eigen::AlignedBox3f>& region) {
  patches_.clear();
  seen_patches_.clear();
  if (prior_) {
    prior_->update(map, space);
    emit_prior(region);
  }
  const Surfels& surfels = map.surfels();
  // Free space may become unknown again when has_false_misses() changes.
  if (std::exchange(had_false_misses_, space.has_false_misses()) != space.has_false_misses())
    asked_.clear();
  asked_.resize(surfels.size());
  constexpr std::size_t some = 512;  // surfels per part
  std::vector<std::vector<PredictedPatch>> predictions((surfels.size() + some - 1) / some);
  geometry::parallel_for(predictions.size(), settings_.threads, [&](std::size_t part) {
    const std::size_t end = std::min(surfels.size(), (part + 1) * some);
    for (std::size_t i = part * some; i < end; ++i) {
      if (surfels.open_directions[i] != 0) emit_chains(map, space, i, region, predictions[part]);
    }
  });
  for (const std::vector<PredictedPatch>& part : predictions) {
    for (const PredictedPatch& prediction : part) {
      if (!seen_patches_.insert(prediction.key).second || is_predicted_by_prior(prediction))
        continue;
      const auto trust = trusts_.find(prediction.key);
      patches_.push_back(prediction);
      patches_.back().weight *= trust == trusts_.end() ? 1.0F : trust->second;
    }
  }
}

void PredictedSurface::emit_chains(const SurfelMap& map, const FreeSpaceHistory& space,
                                   std::size_t surfel,
                                   const std::optional<Eigen::AlignedBox3f>& region,
                                   std::vector<PredictedPatch>& predictions) {
  const Surfels& surfels = map.surfels();
  const Vector3f &position = surfels.positions[surfel], &normal = surfels.normals[surfel];
  AskedChains& asked = asked_[surfel];
  if (asked.position != position || asked.normal != normal) asked = {position, normal, {}};
  for (int k = 0; k < 6; ++k) {
    if ((surfels.open_directions[surfel] >> k & 1U) == 0) continue;
    for (const auto continuation :
         {Continuation::straight, Continuation::convex, Continuation::concave}) {
      emit_chain(map, space, surfel, k, continuation, region, predictions);
    }
    const auto is_known_at_once = [&](Continuation continuation) {
      return asked.chains[chain_number(k, continuation)].unknown_steps == 0;
    };
    if (is_known_at_once(Continuation::straight) && is_known_at_once(Continuation::convex) &&
        !map.has_other_face_near(surfel)) {
      emit_chain(map, space, surfel, k, Continuation::back, region, predictions);
    }
  }
}

void PredictedSurface::emit_chain(const SurfelMap& map, const FreeSpaceHistory& space,
                                  std::size_t surfel, int direction, Continuation continuation,
                                  const std::optional<Eigen::AlignedBox3f>& region,
                                  std::vector<PredictedPatch>& predictions) {
  const Surfels& surfels = map.surfels();
  const float h = map.spacing();
  const Vector3f& origin = surfels.positions[surfel];
  const Vector3f& up = surfels.normals[surfel];
  const Vector3f along = open_direction(surfels, surfel, direction);
  AskedChain& asked = asked_[surfel].chains[chain_number(direction, continuation)];
  const std::size_t first_image = asked.images;
  asked.images = static_cast<std::uint32_t>(space.image_count());
  for (int step = 0; step < settings_.steps; ++step) {
    const float scale = static_cast<float>(1 << step);
    PredictedPatch patch;
    switch (continuation) {
      case Continuation::straight:
      case Continuation::beyond:
        patch.position = origin + along * (1.6F * h * scale);
        patch.normal = up;
        break;
      case Continuation::convex:
        patch.position = origin + along * (1.1F * h) - up * (1.1F * h * scale);
        patch.normal = along;
        break;
      case Continuation::concave:
        patch.position = origin + along * (1.1F * h) + up * (1.1F * h * scale);
        patch.normal = -along;
        break;
      case Continuation::back:
        patch.position = origin - along * (h * (scale - 1.0F)) - up * (1.1F * h);
        patch.normal = -up;
        break;
    }
    if (region && !region->contains(patch.position)) return;
    if (step >= asked.unknown_steps) return;
    const SpaceState state = space.query_surface(patch.position, patch.normal, first_image);
    if (!is_unknown(state)) {
      asked.unknown_steps = step;
      return;
    }
    if (state == SpaceState::hidden) asked.looked_at |= static_cast<std::uint8_t>(1U << step);
    const bool was_looked_at = (asked.looked_at >> step & 1U) != 0;
    const Continuation kind = continuation == Continuation::straight && !was_looked_at
                                  ? Continuation::beyond
                                  : continuation;
    patch.is_unobserved = !was_looked_at;
    if (settings_.is_unobserved_only && was_looked_at) continue;
    patch.edge = std::max(h, 0.8F * h * scale);
    patch.kind = rate_index(kind, step);
    patch.key = patch_key(patch.position, patch.normal, patch.edge, step);
    patch.weight = patch.edge * patch.edge * static_cast<float>(hit_rate(kind, step));
    predictions.push_back(patch);
  }
}

void PredictedSurface::emit_prior(const std::optional<Eigen::AlignedBox3f>& region) {
  for (std::size_t i = 0; i < prior_->patches().size(); ++i) {
    const PriorPatch& prediction = prior_->patches()[i];
    if (prior_->state(i) != PriorPredictions::State::open) continue;
    if (region && !region->contains(prediction.position)) continue;
    const std::uint64_t key = prior_key | i;
    const auto trust = trusts_.find(key);
    const float weight = prediction.area * static_cast<float>(prior_hit_rate()) *
                         (trust == trusts_.end() ? 1.0F : trust->second);
    patches_.push_back({prediction.position, prediction.normal, std::sqrt(prediction.area), weight,
                        prior_kind, key});
  }
}

bool PredictedSurface::is_predicted_by_prior(const PredictedPatch& patch) const {
  return prior_ && prior_hit_rate() >= trusted_prior_rate &&
         prior_->is_open_near(patch.position, patch.edge);
}

std::optional<double> PredictedSurface::found_share(const PredictedPatch& patch,
                                                    const SurfelMap& map,
                                                    std::size_t first_new) const {
  if (patch.kind == prior_kind) {
    if (prior_->state(patch.key & ~prior_key) == PriorPredictions::State::found) return 1.0;
    return std::nullopt;
  }
  const float reach = 0.5F * map.spacing() + 0.75F * patch.edge;
  if (!(map.area_near(patch.position, reach, first_new) > 0.0)) return std::nullopt;
  if (patch.edge <= map.spacing()) return 1.0;
  // Radius of a ball that cuts an area as large as the square out of a surface through its centre.
  const float square = patch.edge * patch.edge;
  const float radius = std::sqrt(square / std::numbers::pi_v<float>);
  return std::min(1.0, map.area_near(patch.position, radius, first_new) / double{square});
}

void PredictedSurface::grade(std::span<const Expected> expected, const SurfelMap& map,
                             const FreeSpaceHistory& space, std::size_t first_new) {
  if (prior_) prior_->update(map, space);
  std::array<Rate, std::tuple_size_v<decltype(rates_)>> found = {};
  for (const auto& [i, line_of_sight_probability] : expected) {
    const PredictedPatch& patch = patches_[i];
    const std::optional<double> share = found_share(patch, map, first_new);
    found[patch.kind].tries += line_of_sight_probability;
    found[patch.kind].hits += line_of_sight_probability * share.value_or(0.0);
    if (!share && is_unknown(space.query_surface(patch.position, patch.normal))) {
      trusts_.try_emplace(patch.key, 1.0F).first->second *=
          1.0F - line_of_sight_probability * (1.0F - disappointment);
    }
  }
  if (!settings_.learns_rates) return;
  for (std::size_t kind = 0; kind < rates_.size(); ++kind) {
    if (found[kind].tries == 0.0) continue;
    Rate& rate = rates_[kind];
    const double kept = settings_.retention;
    const double weight = std::min(correlation, max_evidence / found[kind].tries);
    rate.hits = kept * rate.hits + weight * found[kind].hits;
    rate.tries = kept * rate.tries + weight * found[kind].tries;
  }
}

LineOfSightModel::LineOfSightModel(float scale) {
  std::array<float, sections> lengths{};
  float from = 0.0F;
  for (std::size_t section = 0; section < sections; ++section) {
    lengths[section] =
        stretch * scale * static_cast<float>(1U << section) / static_cast<float>(all_unknown);
    middles_[section] = from + 0.5F * lengths[section];
    from += lengths[section];
  }
  for (std::uint32_t unknown = 0; unknown <= all_unknown; ++unknown) {
    float length = 0.0F;
    for (std::size_t section = 0; section < sections; ++section) {
      if ((unknown >> section & 1U) != 0) length += lengths[section];
    }
    probabilities_[unknown] = std::exp(-length / scale);
  }
  const auto middle = [](std::size_t cell) {
    return (2.0F * static_cast<float>(cell) + 1.0F) / directions_per_edge - 1.0F;
  };
  std::size_t ray_index = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      for (std::size_t i = 0; i < directions_per_edge; ++i) {
        for (std::size_t j = 0; j < directions_per_edge; ++j) {
          Vector3f& direction = directions_[ray_index++];
          direction[axis] = side;
          direction[(axis + 1) % 3] = middle(i);
          direction[(axis + 2) % 3] = middle(j);
          direction.normalize();
        }
      }
    }
  }
}

std::size_t LineOfSightModel::direction_index(const Vector3f& offset) {
  Eigen::Index axis = 0;
  const float longest = offset.cwiseAbs().maxCoeff(&axis);
  const auto cell = [&](Eigen::Index other) {
    const float share = 0.5F * (offset[other % 3] / longest + 1.0F);
    return std::min(static_cast<std::size_t>(directions_per_edge * share),
                    std::size_t{directions_per_edge - 1});
  };
  const std::size_t face = 2 * static_cast<std::size_t>(axis) + (offset[axis] > 0.0F ? 1 : 0);
  return (face * directions_per_edge + cell(axis + 1)) * directions_per_edge + cell(axis + 2);
}

void LineOfSightModel::update(std::span<const PredictedPatch> patches,
                              const FreeSpaceHistory& space, unsigned threads) {
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> known_as(patches.size(), none);
  std::unordered_map<std::uint64_t, Row> rows;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const PredictedPatch& patch = patches[i];
    const auto old = rows_.find(patch.key);
    // The patch of another surfel may have the same identifier at a slightly different position.
    if (old != rows_.end() && old->second.position == patch.position) {
      known_as[i] = old->second.number;
    }
    rows.emplace(patch.key, Row{i, patch.position});
  }
  std::vector<std::uint32_t> asked(direction_count * patches.size());
  geometry::parallel_for(direction_count, threads, [&](std::size_t ray_index) {
    const std::size_t first = ray_index * patches_.size();
    std::ranges::transform(
        known_as, asked.begin() + static_cast<std::ptrdiff_t>(ray_index * patches.size()),
        [&](std::size_t old) { return old == none ? all_unknown : asked_[first + old]; });
  });
  asked_ = std::move(asked);
  rows_ = std::move(rows);
  patches_ = patches;
  space_ = &space;
}

float LineOfSightModel::of(std::size_t i, const Vector3f& sensor) const {
  const PredictedPatch& patch = patches_[i];
  const auto images = static_cast<std::uint32_t>(space_->image_count());
  if (images == 0 || patch.kind == prior_kind) return 1.0F;
  const Vector3f offset = sensor - patch.position;
  const std::size_t ray_index = offset.isZero() ? 0 : direction_index(offset);
  // Concurrent threads compute the same result.
  std::atomic_ref<std::uint32_t> asked(asked_[ray_index * patches_.size() + i]);
  const std::uint32_t before = asked.load(std::memory_order_relaxed);
  std::uint32_t unknown = before & all_unknown;
  const std::uint32_t first = before >> sections;
  if (first == images) return probabilities_[unknown];
  for (std::size_t section = 0; section < sections; ++section) {
    if ((unknown >> section & 1U) == 0) continue;
    const Vector3f at = patch.position + middles_[section] * directions_[ray_index];
    if (!is_unknown(space_->query(at, first))) unknown &= ~(1U << section);
  }
  asked.store(images << sections | unknown, std::memory_order_relaxed);
  return probabilities_[unknown];
}

}  // namespace skycap::survey::surfel
