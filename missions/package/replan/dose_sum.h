/// What a set of views covers: the dose that each target gets of all their looks
/// (survey/skycap/dose_model.h), kept up to date while views come and go. Everything is counted in
/// whole numbers, so that the order of coming and going leaves no trace.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "survey/skycap/view_gain.h"

namespace skycap::missions::package {

/// A look as it is counted.
struct Dose {
  std::uint32_t target;
  std::uint32_t hazard;  ///< in 1/256
};

std::vector<Dose> doses_of(std::span<const survey::skycap::Look> looks);

class DoseSum {
 public:
  /// Weighs the targets by their area; there must be one that has some.
  explicit DoseSum(std::span<const survey::skycap::GainField::Target> targets);

  void add(std::span<const Dose> doses);
  /// Of a view that was added.
  void remove(std::span<const Dose> doses);

  /// Expected covered share of the targets' area.
  double covered() const;
  /// Expected area of a target that lacks a measurement, in units of its own.
  std::uint64_t missing(std::uint32_t target) const;
  std::uint32_t size() const { return static_cast<std::uint32_t>(weights_.size()); }

 private:
  std::span<const std::uint64_t> shares_;  ///< missing by hazard
  std::vector<std::uint64_t> weights_;
  std::vector<std::uint32_t> hazards_;
  std::uint64_t all_ = 0;      ///< sum of the weights, with nothing covered
  std::uint64_t missing_ = 0;  ///< of it
};

}  // namespace skycap::missions::package
