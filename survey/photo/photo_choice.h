/// Choice of the fewest photos by which each sample has enough stereo partners.
///
/// Greedy choice on a saturating count, then destroy-and-repair search. Source: Shaw, "Using
/// constraint programming and local search methods to solve vehicle routing problems", 1998.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "geometry/pose/pose.h"
#include "survey/photo/stereo_quality.h"
#include "survey/photo/visibility.h"

namespace skycap::survey::photo {

/// Candidates and the samples that they are chosen for. Must outlive what is made from it.
struct PhotoChoiceProblem {
  std::vector<geometry::View> candidates;
  const TargetSamples* samples = nullptr;
  IndexLists observed;   ///< samples that each candidate observes
  IndexLists observers;  ///< transposed
  StereoRule rule;
  unsigned threads = 1;  ///< zero: all processors; does not change the result
};

/// The problem of these photos for the observer's samples. Where photos at the same position are
/// kept apart (`one_each` false) they are candidates that exclude one another; else each sample
/// is observed by the first of them only, as a set of photos is evaluated.
PhotoChoiceProblem photo_choice_problem(std::vector<geometry::View> photos,
                                        const Observer& observer, bool one_each, unsigned threads);

/// The problem with some of its candidates, in the order given.
PhotoChoiceProblem with_candidates(const PhotoChoiceProblem& problem,
                                   std::span<const std::uint32_t> candidates);

/// A set of chosen photos with the state of each sample. A sample's worth is 0 without
/// observations, else min(K + 1, 1 + its largest number of stereo partners), plus 0.3 min(1, h).
class PhotoChoice {
 public:
  explicit PhotoChoice(const PhotoChoiceProblem& problem);
  PhotoChoice(PhotoChoice&&) noexcept;
  PhotoChoice& operator=(PhotoChoice&&) noexcept;
  ~PhotoChoice();

  void add(std::uint32_t candidate);
  void remove(std::uint32_t candidate);

  /// Candidates chosen, in the order in which they were added.
  const std::vector<std::uint32_t>& chosen() const;
  /// Samples with at least K stereo partners.
  std::size_t satisfied() const;
  /// Whether a sample has at least K stereo partners.
  bool is_satisfied(std::size_t sample) const;
  /// Stereo partners k of a sample: -2 without observations, -1 with one.
  int partners(std::size_t sample) const;
  /// Smith's reconstructability h of a sample.
  double reconstructability(std::size_t sample) const;

  /// When greedy() stops.
  struct Limits {
    double min_gain = 0.0;                    ///< of the best photo, in samples' worths
    std::size_t max_photos = 1U << 20;        ///< chosen in all
    std::size_t enough_satisfied = SIZE_MAX;  ///< samples
  };
  /// Adds the photo of the greatest gain, again and again. Photos nearer than 0.05 d to a chosen
  /// one are skipped. `added` is told after each.
  void greedy(const Limits& limits, const std::function<void()>& added = {});

  struct Repair {
    std::size_t rounds = 900;
    std::uint64_t seed = 1;
  };
  /// Repeats: removes the 6 to 18% of the photos nearest to one of them, by distance + 0.5 d times
  /// the difference of directions. Then refills greedily for the samples that have lost
  /// satisfaction. Keeps the result if no fewer samples are satisfied than before the search, by no
  /// more photos. Ends early after a stop.
  void destroy_and_repair(const Repair& options, const std::stop_token& stop = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// No choice of candidates that satisfies these samples has fewer photos: each needs K + 1
/// observations. Lagrangian bound of the covering problem by subgradient ascent (Held, Wolfe and
/// Crowder, "Validation of subgradient optimization", 1974); ignores angles.
struct CoverBound {
  double relaxed = 0.0;    ///< bound of the linear relaxation
  std::size_t photos = 0;  ///< the same as an integer
};
CoverBound cover_bound(const PhotoChoiceProblem& problem, std::span<const std::uint32_t> samples,
                       int observations, std::size_t upper_bound);

}  // namespace skycap::survey::photo
