/// Guesses where the surface goes on, unseen, beyond the edge of what was measured.
///
/// A surfel without a neighbour in some direction emits three chains of hypothetical patches:
/// straight on, bent away (over a convex edge) and bent towards the free side (a concave edge), at
/// distances that double. A chain ends at the first patch whose place is not unknown: what the
/// sensor saw through cannot be surface. How much a hypothesis is worth is learnt: each kind of
/// patch has a hit rate, updated after each scan with what appeared where it was expected, and a
/// place that disappointed counts less each time. Nothing is forbidden for good.
///
/// What is thought to be there beforehand (prior_guesses.h) is one more kind, graded as the others:
/// where it is wrong, its rate falls with each scan that should have shown it.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "survey/skycap/dose_map.h"
#include "survey/skycap/prior_guesses.h"
#include "survey/skycap/space_memory.h"

namespace skycap::survey::skycap {

enum class Continuation : std::uint8_t { straight, convex, concave };

/// UnseenPatch::kind of what is thought to be there beforehand.
inline constexpr std::uint8_t prior_kind = 15;

struct UnseenPatch {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  ///< unit
  float edge;              ///< of the square that it stands for
  float weight;            ///< area times the probability that there is surface
  std::uint8_t kind;       ///< 3 * step + continuation, or prior_kind
  std::uint64_t place;     ///< names the hypothesis: same place, facing and step, same number
};

struct UnseenSurfaceSettings {
  int steps = 3;             ///< patches in a chain, at most 5
  bool learns_rates = true;  ///< otherwise the rates stay at their first guesses
  float memory = 0.85F;      ///< share of the evidence on rates kept from scan to scan
};

class UnseenSurface {
 public:
  explicit UnseenSurface(const UnseenSurfaceSettings& settings);

  /// What is thought to be there, guessed from the next prediction on.
  void expect(PriorGuesses prior) { prior_.emplace(std::move(prior)); }

  /// Derives the patches anew from the surfels and from what is known of space.
  void predict(const DoseMap& map, const SpaceMemory& space,
               const std::optional<Eigen::AlignedBox3f>& region);

  /// A patch, by its index, that a scan should have shown if it is there, with the probability
  /// that nothing hides it.
  struct Expected {
    std::uint32_t patch;
    float clearness;
  };

  /// Learns from a scan that should have shown the patches `expected`; the map and the
  /// space memory hold the scan already, its surfels from index `first_new` on. Call before
  /// predict().
  void grade(std::span<const Expected> expected, const DoseMap& map, const SpaceMemory& space,
             std::size_t first_new);

  const std::vector<UnseenPatch>& patches() const { return patches_; }

  /// What hides patches of the prior kind from each other.
  std::vector<Eigen::Vector3f> prior_occluders() const {
    return prior_ ? prior_->standing() : std::vector<Eigen::Vector3f>{};
  }

  /// Probability that a patch of that kind and step is there.
  double hit_rate(Continuation continuation, int step) const;

  /// Probability that what is thought to be there beforehand is there.
  double prior_hit_rate() const { return rates_[prior_kind].hits / rates_[prior_kind].tries; }

 private:
  struct Rate {
    double hits, tries;
  };
  /// What earlier predictions found out. Places become known, and never unknown again, so that only
  /// new images have to be asked.
  struct AskedChain {
    std::uint32_t images = 0;                             ///< of the space memory that were asked
    int unknown_steps = std::numeric_limits<int>::max();  ///< no patch from this step on
  };
  /// Those of one surfel, by direction and continuation, as long as it stays where it is.
  struct AskedChains {
    Eigen::Vector3f position = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
    std::array<AskedChain, 18> chains;
  };
  void emit_chain(const DoseMap& map, const SpaceMemory& space, std::size_t surfel, int direction,
                  Continuation continuation, const std::optional<Eigen::AlignedBox3f>& region);
  void emit_prior(const std::optional<Eigen::AlignedBox3f>& region);
  /// Whether the prior, while it is to be trusted, has a patch there that is still open.
  bool is_told_by_prior(const UnseenPatch& patch) const;
  /// The share of what was guessed that a scan has shown whose surfels begin at `first_new`; nothing
  /// if it has shown no surface there.
  std::optional<double> found_share(const UnseenPatch& patch, const DoseMap& map,
                                    std::size_t first_new) const;

  UnseenSurfaceSettings settings_;
  std::array<Rate, 16> rates_;  ///< by UnseenPatch::kind
  std::optional<PriorGuesses> prior_;
  std::vector<UnseenPatch> patches_;
  std::vector<AskedChains> asked_;                   ///< by surfel
  std::unordered_set<std::uint64_t> seen_places_;    ///< of the prediction under way
  std::unordered_map<std::uint64_t, float> trusts_;  ///< of places that disappointed
};

}  // namespace skycap::survey::skycap
