#include "flight/monte_carlo/nearest_pass.h"

#include <algorithm>

namespace skycap::flight {
namespace {

/// Search distance beyond the current minimum, which saves queries for later steps [m].
constexpr double look_ahead = 2.0;

}  // namespace

bool NearestPass::pass(const Segment& step) {
  const double moved = std::max((step.from - known_at_).norm(), (step.to - known_at_).norm());
  if (known_free_ - moved >= nearest_.distance) return false;
  const Closest found = space_.closest(step, nearest_.distance + look_ahead);
  known_at_ = step.to;
  known_free_ = found.distance;
  if (found.kind == ObstacleKind::none || found.distance >= nearest_.distance) return false;
  nearest_ = found;
  return true;
}

}  // namespace skycap::flight
