/// Prediction of unobserved surface beyond the edge of the measured surface.
///
/// A surfel without a neighbour in some direction emits three chains of hypothetical patches at
/// doubling distances. One continues straight, one bends away (over a convex edge), and one bends
/// towards the free side (at a concave edge). If the first two are refuted and no other face is
/// nearby, the surfel is at the edge of a thin object. A fourth chain then predicts its back. A
/// chain ends at the first patch whose position is not unknown, because the sensor cannot see
/// through surface.
///
/// The value of a hypothesis is learnt. Each kind of patch has a hit rate, which is updated after
/// each scan by comparison with the predicted surface. The weight of a place decreases with each
/// failure, but never to zero. Straight continuations beyond the border of all images are a
/// separate kind. Only the image border cuts off the surface there, so that it is much more likely
/// to continue.
///
/// The prior surface (prior_guesses.h) is another kind, evaluated in the same way: its rate
/// decreases with each scan that should have shown it but did not.
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

#include "survey/surfel/free_space_history.h"
#include "survey/surfel/prior_predictions.h"
#include "survey/surfel/surfel_map.h"

namespace skycap::survey::surfel {

/// Kinds of continuation. `back` is the other side of a thin object; `beyond` is a straight
/// continuation outside all images.
enum class Continuation : std::uint8_t { straight, convex, concave, back, beyond };
inline constexpr int continuations = 5;

/// PredictedPatch::kind of patches from the prior surface.
inline constexpr std::uint8_t prior_kind = 25;

struct PredictedPatch {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  ///< unit vector
  float edge;              ///< edge length of the patch, a square [m]
  float weight;            ///< area times the probability that the surface exists [m^2]
  std::uint8_t kind;       ///< 5 * step + continuation, or prior_kind
  std::uint64_t
      key;  ///< identifier of the hypothesis, computed from position, orientation and step
  bool is_unobserved = false;  ///< outside all images, or beyond the sensor's range in each of them
};

struct PredictedSurfaceSettings {
  int steps = 3;                    ///< patches per chain, at most 5
  bool learns_rates = true;         ///< if false, the rates keep their initial values
  float retention = 0.85F;          ///< fraction of the evidence on rates kept from scan to scan
  unsigned threads = 1;             ///< zero: all processors
  bool is_unobserved_only = false;  ///< omit patches that an image contains within range
};

class PredictedSurface {
 public:
  explicit PredictedSurface(const PredictedSurfaceSettings& settings);

  /// Sets the prior surface, used from the next prediction on.
  void expect(PriorPredictions prior) { prior_.emplace(std::move(prior)); }

  /// Recomputes the patches from the surfels and the free-space memory.
  void predict(const SurfelMap& map, const FreeSpaceHistory& space,
               const std::optional<Eigen::AlignedBox3f>& region);

  /// Patch that a scan should have shown if it exists, with its line-of-sight confidence.
  struct Expected {
    std::uint32_t patch;
    float line_of_sight_probability;
  };

  /// Updates the hit rates after a scan that should have shown the patches `expected`. The map and
  /// the free-space memory must already contain the scan, with its surfels from index `first_new`
  /// on. Must be called before predict().
  void grade(std::span<const Expected> expected, const SurfelMap& map,
             const FreeSpaceHistory& space, std::size_t first_new);

  const std::vector<PredictedPatch>& patches() const { return patches_; }

  /// Returns the positions of prior patches, which occlude each other.
  std::vector<Eigen::Vector3f> prior_occluders() const {
    return prior_ ? prior_->standing() : std::vector<Eigen::Vector3f>{};
  }

  /// Returns the probability that a patch of this kind and step exists.
  double hit_rate(Continuation continuation, int step) const;

  /// Returns the probability that a patch of the prior surface exists.
  double prior_hit_rate() const { return rates_[prior_kind].hits / rates_[prior_kind].tries; }

 private:
  struct Rate {
    double hits, tries;
  };
  /// Cached results of earlier predictions. A known place never becomes unknown again, so that only
  /// new images must be queried.
  struct AskedChain {
    std::uint32_t images = 0;  ///< number of images of the free-space memory that were queried
    int unknown_steps =
        std::numeric_limits<int>::max();  ///< number of the first step without a patch
    std::uint8_t looked_at = 0;           ///< bit mask of the steps that an image has observed
  };
  /// Cached chains of one surfel, valid while it does not move.
  struct AskedChains {
    Eigen::Vector3f position = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
    std::array<AskedChain, 24> chains;  ///< by direction and continuation
  };
  /// Emits the chains of one surfel, independent of other surfels and of failed places. May be
  /// called concurrently for different surfels.
  void emit_chains(const SurfelMap& map, const FreeSpaceHistory& space, std::size_t surfel,
                   const std::optional<Eigen::AlignedBox3f>& region,
                   std::vector<PredictedPatch>& predictions);
  void emit_chain(const SurfelMap& map, const FreeSpaceHistory& space, std::size_t surfel,
                  int direction, Continuation continuation,
                  const std::optional<Eigen::AlignedBox3f>& region,
                  std::vector<PredictedPatch>& predictions);
  void emit_prior(const std::optional<Eigen::AlignedBox3f>& region);
  /// Returns whether the prior surface, if it is reliable, has an open patch at this position.
  bool is_predicted_by_prior(const PredictedPatch& patch) const;
  /// Returns the found fraction of a predicted patch in a scan whose surfels start at `first_new`,
  /// or nullopt if the scan shows no surface there.
  std::optional<double> found_share(const PredictedPatch& patch, const SurfelMap& map,
                                    std::size_t first_new) const;

  PredictedSurfaceSettings settings_;
  std::array<Rate, prior_kind + 1> rates_;  ///< by PredictedPatch::kind
  std::optional<PriorPredictions> prior_;
  std::vector<PredictedPatch> patches_;
  std::vector<AskedChains> asked_;                   ///< by surfel
  bool had_false_misses_ = false;                    ///< has_false_misses() at the last prediction
  std::unordered_set<std::uint64_t> seen_patches_;   ///< places of the current prediction
  std::unordered_map<std::uint64_t, float> trusts_;  ///< weights of places with failed predictions
};

/// Line-of-sight confidence of predicted patches: unknown space in front of a patch may contain
/// occluders, with a probability that grows with its length.
///
/// Let L be the unknown length within the last 3 * `scale` of the path to a patch. The patch is in
/// sight with the probability exp(-L / scale). The paths to a patch are grouped into 54 directions,
/// nine per face of a cube. Each is sampled at the centres of pieces that double in length, when a
/// view first needs it. Known space stays known, so that later only unknown pieces are queried
/// again, in new images.
class LineOfSightModel {
 public:
  /// `scale` is the unknown length with a confidence of 37% [m].
  explicit LineOfSightModel(float scale);

  /// Selects the patches and the free-space memory for subsequent queries. Both must outlive the
  /// queries.
  void update(std::span<const PredictedPatch> patches, const FreeSpaceHistory& space,
              unsigned threads = 1);

  /// Returns the confidence in (0, 1] of patch `i` for a sensor at `sensor`. It is 1 without
  /// images, and for prior patches, whose occluders are known from the prior surface. Thread-safe.
  float of(std::size_t i, const Eigen::Vector3f& sensor) const;

 private:
  static constexpr int sections = 5, directions_per_edge = 3;
  static constexpr std::size_t direction_count = 6UL * directions_per_edge * directions_per_edge;
  static constexpr std::uint32_t all_unknown = (1U << sections) - 1U;

  static std::size_t direction_index(const Eigen::Vector3f& offset);

  std::array<float, sections> middles_;  ///< distances of the piece centres from the patch [m]
  std::array<float, all_unknown + 1> probabilities_;  ///< by bit mask of the unknown pieces
  std::array<Eigen::Vector3f, direction_count> directions_;

  std::span<const PredictedPatch> patches_;
  const FreeSpaceHistory* space_ = nullptr;
  /// Cache by path and patch: bit mask of unknown pieces in the low bits, number of queried images
  /// above them. A sensor sees neighbouring patches along the same path.
  mutable std::vector<std::uint32_t> asked_;
  struct Row {
    std::size_t number;
    Eigen::Vector3f position;
  };
  std::unordered_map<std::uint64_t, Row> rows_;  ///< rows of asked_ by place
};

/// Yield of predictions: found area relative to predicted area over the last scans.
class PredictionYield {
 public:
  /// Updates the yield after a scan with `predicted_sum` m^2 of predicted surface. The scan covered
  /// `beyond_known` m^2 more than predicted for known surface and `new_territory` m^2 without known
  /// surface nearby. The former may be relief or noise and counts up to `predicted_sum` only.
  void learn(double predicted_sum, double beyond_known, double new_territory) {
    if (predicted_sum <= 0.0) return;
    const double found = std::max({0.0, std::min(beyond_known, predicted_sum),
                                   std::min(new_territory, max_growth * predicted_sum)});
    const double kept = predicted_sum_ > 0.0
                            ? std::min(retention, max_history * predicted_sum / predicted_sum_)
                            : 0.0;
    predicted_sum_ = kept * predicted_sum_ + predicted_sum;
    found_ = kept * found_ + found;
    value_ = std::clamp(found_ / predicted_sum_, min, max);
  }

  /// Returns the found area per predicted area, or 1 before the first scan. The value exceeds 1 if
  /// predictions led to larger surfaces.
  double value() const { return value_; }

 private:
  /// Fraction of the earlier evidence that is kept at each scan.
  static constexpr double retention = 0.6;
  /// Maximum weight of earlier predictions relative to the latest one. Large finds at the beginning
  /// of a survey do not predict the small gains at its end.
  static constexpr double max_history = 2.0;
  /// Limits of the value, so that one or two scans without finds do not end a survey and one large
  /// find does not prolong it.
  static constexpr double min = 0.15, max = 6.0, max_growth = 10.0;

  double predicted_sum_ = 0.0, found_ = 0.0;  ///< exponentially weighted sums over the scans [m^2]
  double value_ = 1.0;
};

}  // namespace skycap::survey::surfel
