#include "survey/volumetric/occupancy_states.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace skycap::survey::volumetric {
namespace {

constexpr double free_below = 0.2;
constexpr double occupied_above = 0.8;
constexpr double stops_rays_from = 0.5;

float to_log_odds(double probability) {
  return static_cast<float>(std::log(probability / (1.0 - probability)));
}

VoxelState compute_state(float log_odds) {
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
    : hit_(to_log_odds(model.hit)),
      miss_(to_log_odds(model.miss)),
      clamping_min_(to_log_odds(model.clamping_min)),
      clamping_max_(to_log_odds(model.clamping_max)),
      capacity_(std::clamp<std::size_t>(capacity, first_measured + 2, max_states)),
      states_(first_measured) {
  for (Code depth = 1; depth <= deepest_shadow; ++depth) {
    states_[depth].shadow_depth = depth;
    states_[depth].kind = VoxelKind::shadowed;
  }
}

OccupancyStates::Code OccupancyStates::successor(Code code, float change, Code Value::*known) {
  if (!is_measured(code)) return find_code(std::clamp(change, clamping_min_, clamping_max_));
  const std::size_t number = code - first_measured;
  if (values_[number].*known == untouched) {
    const float next = std::clamp(values_[number].log_odds + change, clamping_min_, clamping_max_);
    const Code next_code = find_code(next);  // may reallocate values_
    values_[number].*known = next_code;
  }
  return values_[number].*known;
}

OccupancyStates::Code OccupancyStates::find_code(float log_odds) {
  if (const auto found = codes_.find(log_odds); found != codes_.end()) return found->second;
  if (states_.size() == capacity_) {
    const auto distance = [&](const Value& value) { return std::abs(value.log_odds - log_odds); };
    const auto nearest = std::ranges::min_element(values_, {}, distance);
    return static_cast<Code>(first_measured + (nearest - values_.begin()));
  }
  const auto code = static_cast<Code>(states_.size());
  states_.push_back(compute_state(log_odds));
  values_.push_back({log_odds});
  codes_.emplace(log_odds, code);
  return code;
}

}  // namespace skycap::survey::volumetric
