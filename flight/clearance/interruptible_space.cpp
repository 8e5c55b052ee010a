#include "flight/clearance/interruptible_space.h"

#include "geometry/interrupted.h"

namespace skycap::flight {
namespace {

void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Interrupted();
}

}  // namespace

Closest InterruptibleSpace::closest(const Segment& leg, double up_to) const {
  throw_if_stopped(stop_);
  return space_.closest(leg, up_to);
}

bool InterruptibleSpace::continues_free(const Segment& leg, double clearance) const {
  throw_if_stopped(stop_);
  return space_.continues_free(leg, clearance);
}

double InterruptibleSpace::surface_distance(const Eigen::Vector3d& point, double up_to) const {
  throw_if_stopped(stop_);
  return space_.surface_distance(point, up_to);
}

}  // namespace skycap::flight
