#include "missions/package/replan/observation_sum.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace skycap::missions::package {
namespace {

constexpr float steps = 256.0F;         ///< Steps per unit of hazard.
constexpr std::size_t max_hazard = 16;  ///< Hazard above which the uncovered fraction is zero.
/// Scales of the integer fractions and weights. Sums over a million targets fit into 64 bits.
constexpr double one_share = 0x1p24, one_weight = 0x1p20;

/// Returns the table of exp(-hazard) by quantised hazard.
std::span<const std::uint64_t> missing_shares() {
  static const auto table = [] {
    std::array<std::uint64_t, max_hazard* static_cast<std::size_t>(steps)> shares{};
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const double missing = std::exp(-static_cast<double>(i) / double{steps});
      shares[i] = static_cast<std::uint64_t>(std::llround(one_share * missing));
    }
    return shares;
  }();
  return table;
}

}  // namespace

std::vector<ObservationStrength> observation_strengths(
    std::span<const survey::surfel::Observation> observations) {
  std::vector<ObservationStrength> strengths;
  strengths.reserve(observations.size());
  for (const survey::surfel::Observation& observation : observations) {
    strengths.push_back(
        {observation.target, static_cast<std::uint32_t>(std::lround(steps * observation.hazard))});
  }
  return strengths;
}

ObservationSum::ObservationSum(std::span<const survey::surfel::GainField::Target> targets)
    : shares_(missing_shares()), hazards_(targets.size(), 0) {
  float heaviest = 0.0F;
  for (const auto& target : targets) heaviest = std::max(heaviest, target.weight);
  for (const auto& target : targets) {
    weights_.push_back(
        static_cast<std::uint64_t>(std::llround(one_weight * target.weight / heaviest)));
    all_ += weights_.back() * shares_.front();
  }
  missing_ = all_;
}

void ObservationSum::add(std::span<const ObservationStrength> strengths) {
  for (const ObservationStrength& strength : strengths) {
    missing_ -= missing(strength.target);
    hazards_[strength.target] += strength.hazard;
    missing_ += missing(strength.target);
  }
}

void ObservationSum::remove(std::span<const ObservationStrength> strengths) {
  for (const ObservationStrength& strength : strengths) {
    missing_ -= missing(strength.target);
    hazards_[strength.target] -= strength.hazard;
    missing_ += missing(strength.target);
  }
}

double ObservationSum::covered() const {
  return 1.0 - static_cast<double>(missing_) / static_cast<double>(all_);
}

std::uint64_t ObservationSum::missing(std::uint32_t target) const {
  const std::uint32_t hazard = hazards_[target];
  return hazard < shares_.size() ? weights_[target] * shares_[hazard] : 0;
}

}  // namespace skycap::missions::package
