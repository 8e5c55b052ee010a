/// Guesses where the surface goes on, unseen, beyond the edge of what was measured.
///
/// A surfel without a neighbour in some direction emits three chains of hypothetical patches:
/// straight on, bent away (over a convex edge) and bent towards the free side (a concave edge), at
/// distances that double. Where the first two are known not to be, and no other face is near, the
/// surfel is at the edge of something thin: a fourth chain guesses its back. A chain ends at the
/// first patch whose place is not unknown: what the sensor saw through cannot be surface. How much
/// a hypothesis is worth is learnt: each kind of patch has a hit rate, updated after each scan with
/// what appeared where it was expected, and a place that disappointed counts less each time.
/// Nothing is forbidden for good. What lies straight on past the border of all images is a kind of
/// its own: only the image's border cut the surface off there, so that it is far likelier to go on.
///
/// What is thought to be there beforehand (prior_guesses.h) is one more kind, graded as the others:
/// where it is wrong, its rate falls with each scan that should have shown it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
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

/// How surface goes on; `back`: as the other side of something thin; `beyond`: straight, where no
/// image looked.
enum class Continuation : std::uint8_t { straight, convex, concave, back, beyond };
inline constexpr int continuations = 5;

/// UnseenPatch::kind of what is thought to be there beforehand.
inline constexpr std::uint8_t prior_kind = 25;

struct UnseenPatch {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  ///< unit
  float edge;              ///< of the square that it stands for
  float weight;            ///< area times the probability that there is surface
  std::uint8_t kind;       ///< 5 * step + continuation, or prior_kind
  std::uint64_t place;     ///< names the hypothesis: same place, facing and step, same number
};

struct UnseenSurfaceSettings {
  int steps = 3;             ///< patches in a chain, at most 5
  bool learns_rates = true;  ///< otherwise the rates stay at their first guesses
  float memory = 0.85F;      ///< share of the evidence on rates kept from scan to scan
  unsigned threads = 1;      ///< zero: all processors
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
    std::uint8_t looked_at = 0;  ///< bit set: by an image, the step's place
  };
  /// Those of one surfel, as long as it stays where it is.
  struct AskedChains {
    Eigen::Vector3f position = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
    std::array<AskedChain, 24> chains;  ///< by direction and continuation
  };
  /// Of one surfel, whatever other surfels emit and places that disappointed aside; may be called
  /// for several at once.
  void emit_chains(const DoseMap& map, const SpaceMemory& space, std::size_t surfel,
                   const std::optional<Eigen::AlignedBox3f>& region,
                   std::vector<UnseenPatch>& guesses);
  void emit_chain(const DoseMap& map, const SpaceMemory& space, std::size_t surfel, int direction,
                  Continuation continuation, const std::optional<Eigen::AlignedBox3f>& region,
                  std::vector<UnseenPatch>& guesses);
  void emit_prior(const std::optional<Eigen::AlignedBox3f>& region);
  /// Whether the prior, while it is to be trusted, has a patch there that is still open.
  bool is_told_by_prior(const UnseenPatch& patch) const;
  /// The share of what was guessed that a scan has shown whose surfels begin at `first_new`;
  /// nothing if it has shown no surface there.
  std::optional<double> found_share(const UnseenPatch& patch, const DoseMap& map,
                                    std::size_t first_new) const;

  UnseenSurfaceSettings settings_;
  std::array<Rate, prior_kind + 1> rates_;  ///< by UnseenPatch::kind
  std::optional<PriorGuesses> prior_;
  std::vector<UnseenPatch> patches_;
  std::vector<AskedChains> asked_;                   ///< by surfel
  bool misses_lied_ = false;                         ///< at the last prediction
  std::unordered_set<std::uint64_t> seen_places_;    ///< of the prediction under way
  std::unordered_map<std::uint64_t, float> trusts_;  ///< of places that disappointed
};

/// How likely it is that nothing hides a guessed place: unknown space before it may hold something,
/// the likelier the more of it there is.
///
/// Of the last stretch of the way to a place, three times `scale` long, L metres are unknown; then
/// the place is in sight with the probability exp(-L / scale). The ways to one place fall into 54
/// directions, nine to a face of a cube. Each is asked about in pieces that double in length, each
/// in its middle, once a view that may use it comes up; and because what is known stays known,
/// later only what was unknown so far is asked, of new images.
class Clearness {
 public:
  /// `scale` [m]: of so much unknown space 37 % lets a look through.
  explicit Clearness(float scale);

  /// Answers for `patches` from now on, with what `space` knows now; both must outlive the answers.
  void update(std::span<const UnseenPatch> patches, const SpaceMemory& space, unsigned threads = 1);

  /// Of patch `i`, for a sensor at `sensor`: in (0, 1]. One without any image, or of what a prior
  /// tells, which tells what hides it too. Safe to call from several threads.
  float of(std::size_t i, const Eigen::Vector3f& sensor) const;

 private:
  static constexpr int pieces = 5, ways_to_a_face = 3;
  static constexpr std::size_t ways = 6UL * ways_to_a_face * ways_to_a_face;
  static constexpr std::uint32_t all_unknown = (1U << pieces) - 1U;

  static std::size_t way_towards(const Eigen::Vector3f& offset);

  std::array<float, pieces> middles_;                 ///< of the pieces, from the place [m]
  std::array<float, all_unknown + 1> probabilities_;  ///< by the unknown pieces
  std::array<Eigen::Vector3f, ways> directions_;

  std::span<const UnseenPatch> patches_;
  const SpaceMemory* space_ = nullptr;
  /// Of each way and patch: the pieces that are unknown, below the number of images asked. A sensor
  /// sees neighbours by the same way.
  mutable std::vector<std::uint32_t> asked_;
  struct Row {
    std::size_t number;
    Eigen::Vector3f position;
  };
  std::unordered_map<std::uint64_t, Row> rows_;  ///< of asked_, by the names of places
};

/// What guesses are worth: how much surface came of those that the last scans should have shown.
class GuessYield {
 public:
  /// A scan was promised `promised` square metres of guesses; it covered `beyond_known` more than
  /// known surface had promised, and `new_territory` where nothing was known nearby. The former may
  /// be relief, or noise, and counts for at most what was promised.
  void learn(double promised, double beyond_known, double new_territory) {
    if (promised <= 0.0) return;
    const double found = std::max(
        {0.0, std::min(beyond_known, promised), std::min(new_territory, most_at_once * promised)});
    const double kept = promised_ > 0.0 ? std::min(memory, most_past * promised / promised_) : 0.0;
    promised_ = kept * promised_ + promised;
    found_ = kept * found_ + found;
    value_ = std::clamp(found_ / promised_, least, most);
  }

  /// Area found for each square metre that was promised; 1 as long as nothing is known. More than 1
  /// where guesses were the beginning of something larger.
  double value() const { return value_; }

 private:
  /// The share of the evidence that a scan keeps of those before it.
  static constexpr double memory = 0.6;
  /// What was promised before counts for no more than so many times what a scan was promised: the
  /// large finds at the beginning say little of the small promises at the end.
  static constexpr double most_past = 2.0;
  /// A scan or two without any find must not end a survey, nor one great find keep it going.
  static constexpr double least = 0.15, most = 6.0, most_at_once = 10.0;

  double promised_ = 0.0, found_ = 0.0;  ///< fading sums over the scans [m^2]
  double value_ = 1.0;
};

}  // namespace skycap::survey::skycap
