/// Coverage of a set of views: the total hazard of each target over all observations
/// (survey/surfel/coverage_model.h), updated incrementally. Integer arithmetic makes the result
/// independent of the order of additions and removals.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "survey/surfel/view_gain.h"

namespace skycap::missions::package {

/// Quantised observation.
struct ObservationStrength {
  std::uint32_t target;
  std::uint32_t hazard;  ///< Hazard in units of 1/256.
};

std::vector<ObservationStrength> observation_strengths(
    std::span<const survey::surfel::Observation> observations);

class ObservationSum {
 public:
  /// Weights targets by area. At least one target must have a non-zero area.
  explicit ObservationSum(std::span<const survey::surfel::GainField::Target> targets);

  void add(std::span<const ObservationStrength> strengths);
  /// Removes the doses of a view that was added before.
  void remove(std::span<const ObservationStrength> strengths);

  /// Returns the expected covered fraction of the targets' area.
  double covered() const;
  /// Returns the expected uncovered area of a target, in internal integer units.
  std::uint64_t missing(std::uint32_t target) const;
  std::uint32_t size() const { return static_cast<std::uint32_t>(weights_.size()); }

 private:
  std::span<const std::uint64_t> shares_;  ///< Uncovered fractions by hazard.
  std::vector<std::uint64_t> weights_;
  std::vector<std::uint32_t> hazards_;
  std::uint64_t all_ = 0;      ///< Weighted sum with zero coverage.
  std::uint64_t missing_ = 0;  ///< Uncovered part of `all_`.
};

}  // namespace skycap::missions::package
