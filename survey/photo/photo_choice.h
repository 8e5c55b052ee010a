/// Selection of a minimum set of photos in which each sample has enough stereo partners.
///
/// Greedy selection with a saturating count, followed by destroy-and-repair search. Source: Shaw,
/// "Using constraint programming and local search methods to solve vehicle routing problems", 1998.
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

/// Candidates and the samples that they observe. Must outlive all objects created from it.
struct PhotoChoiceProblem {
  std::vector<geometry::View> candidates;
  const TargetSamples* samples = nullptr;
  IndexLists observed;   ///< Samples that each candidate observes.
  IndexLists observers;  ///< Candidates that observe each sample: `observed`, transposed.
  StereoRule rule;
  unsigned threads = 1;  ///< Zero: all processors. Does not affect the result.
};

/// Creates the problem for the photos and the observer's samples. With `one_each`, only the first
/// of several photos at the same position observes a sample, as in the evaluation of a set.
/// Otherwise photos at the same position remain separate candidates that exclude each other.
PhotoChoiceProblem photo_choice_problem(std::vector<geometry::View> photos,
                                        const Observer& observer, bool one_each, unsigned threads);

/// Returns the problem restricted to these candidates, in the given order.
PhotoChoiceProblem with_candidates(const PhotoChoiceProblem& problem,
                                   std::span<const std::uint32_t> candidates);

/// Set of selected photos with the state of each sample. The value of a sample is 0 without
/// observations, otherwise min(K + 1, 1 + its largest number of stereo partners) + 0.3 min(1, h).
class PhotoChoice {
 public:
  explicit PhotoChoice(const PhotoChoiceProblem& problem);
  PhotoChoice(PhotoChoice&&) noexcept;
  PhotoChoice& operator=(PhotoChoice&&) noexcept;
  ~PhotoChoice();

  void add(std::uint32_t candidate);
  void remove(std::uint32_t candidate);

  /// Returns the selected candidates in the order in which they were added.
  const std::vector<std::uint32_t>& chosen() const;
  /// Returns the number of samples with at least K stereo partners.
  std::size_t satisfied() const;
  /// Returns true if a sample has at least K stereo partners.
  bool is_satisfied(std::size_t sample) const;
  /// Returns the number k of stereo partners of a sample: -2 without observations, -1 with one.
  int partners(std::size_t sample) const;
  /// Returns Smith's reconstructability h of a sample.
  double reconstructability(std::size_t sample) const;

  /// Stopping criteria of greedy().
  struct Limits {
    double min_gain = 0.0;              ///< Minimum gain of a photo, as a sum of sample values.
    std::size_t max_photos = 1U << 20;  ///< Maximum number of selected photos.
    std::size_t enough_satisfied = SIZE_MAX;  ///< Number of satisfied samples that is sufficient.
  };
  /// Repeatedly adds the photo with the largest gain. Photos closer than 0.05 d to a selected one
  /// are skipped. Calls `added` after each photo.
  void greedy(const Limits& limits, const std::function<void()>& added = {});

  struct Repair {
    std::size_t rounds = 900;
    std::uint64_t seed = 1;
  };
  /// Repeatedly removes a cluster of 6 to 18% of the photos around a photo, by distance + 0.5 d
  /// times the difference of directions. Then adds photos greedily for the samples that are no
  /// longer satisfied. Keeps the result if it satisfies at least as many samples as at the start of
  /// the search, with at most as many photos. Does nothing if no sample is satisfied. Ends early
  /// after a stop request.
  void destroy_and_repair(const Repair& options, const std::stop_token& stop = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::survey::photo
