#include "survey/volumetric/occupancy_states.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace skycap::survey::volumetric {
namespace {

constexpr double free_below = 0.2;
constexpr double occupied_above = 0.8;
constexpr double stops_rays_from = 0.5;

float log_odds_of(double probability) {
  return static_cast<float>(std::log(probability / (1.0 - probability)));
}

VoxelState state_of(float log_odds) {
  const double p = 1.0 - 1.0 / (1.0 + std::exp(double{log_odds}));
  VoxelState state;
  state.occupancy = p;
  state.entropy = -p * std::log(p) - (1.0 - p) * std::log1p(-p);
  state.kind = p < free_below       ? VoxelKind::free
               : p > occupied_above ? VoxelKind::occupied
                                    : VoxelKind::uncertain;
  state.stops_rays = p >= stops_rays_from;
  return state;
}

}  // namespace

OccupancyStates::OccupancyStates(const OccupancyModel& model, std::size_t capacity)
    : hit_(log_odds_of(model.hit)),
      miss_(log_odds_of(model.miss)),
      lowest_(log_odds_of(model.lowest)),
      highest_(log_odds_of(model.highest)),
      capacity_(std::clamp<std::size_t>(capacity, first_measured + 2, most_states)),
      states_(first_measured) {
  for (Code depth = 1; depth <= deepest_shadow; ++depth) {
    states_[depth].shadow_depth = depth;
    states_[depth].kind = VoxelKind::shadowed;
  }
}

OccupancyStates::Code OccupancyStates::successor(Code code, float change, Code Value::*known) {
  if (!is_measured(code)) return code_of(std::clamp(change, lowest_, highest_));
  const std::size_t number = code - first_measured;
  if (values_[number].*known == untouched) {
    const float next = std::clamp(values_[number].log_odds + change, lowest_, highest_);
    const Code next_code = code_of(next);  // may reallocate values_
    values_[number].*known = next_code;
  }
  return values_[number].*known;
}

OccupancyStates::Code OccupancyStates::code_of(float log_odds) {
  if (const auto found = codes_.find(log_odds); found != codes_.end()) return found->second;
  if (states_.size() == capacity_) {
    const auto distance = [&](const Value& value) { return std::abs(value.log_odds - log_odds); };
    const auto nearest = std::ranges::min_element(values_, {}, distance);
    return static_cast<Code>(first_measured + (nearest - values_.begin()));
  }
  const auto code = static_cast<Code>(states_.size());
  states_.push_back(state_of(log_odds));
  values_.push_back({log_odds});
  codes_.emplace(log_odds, code);
  return code;
}

}  // namespace skycap::survey::volumetric
