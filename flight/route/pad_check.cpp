#include "flight/route/pad_check.h"

#include <algorithm>
#include <string>

#include "flight/clearance/position_text.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

void check_climb(const FreeSpace& space, const std::string& position, const Segment& climb,
                 double clearance) {
  if (space.is_free(climb, clearance)) return;
  const Closest closest = space.closest(climb, clearance + 1.0);
  throw Error(ErrorKind::bad_config,
              "the climb from " + position + " comes within " + length_text(closest.distance) +
                  " of " + space.name(closest) + " at " + position_text(closest.on_leg) +
                  "; the clearance is " + length_text(clearance) + "; move the point");
}

}  // namespace

void check_pad(const FreeSpace& space, const FreeSpace* pad_space, const RouteOptions& options) {
  const double clearance = options.clearance.total();
  const Vector3d& pad = options.takeoff;
  const Vector3d home = pad + Vector3d(0.0, 0.0, options.takeoff_climb);
  if (!space.is_free({home, home}, clearance)) {
    const Closest closest = space.closest({home, home}, clearance + 1.0);
    throw Error(ErrorKind::bad_config,
                "the end of the take-off climb, " + position_text(home) + ", is " +
                    length_text(closest.distance) + " from " + space.name(closest) +
                    "; the clearance is " + length_text(clearance) +
                    "; move the take-off point or raise flight.takeoff_climb");
  }
  check_landing_surfaces(options.landing_surfaces, options.ground_limits);
  const double min = clearance + pad_roughness + options.ground_limits.height_error;
  const Vector3d low(pad.x(), pad.y(), std::min(home.z(), pad.z() + min));
  check_climb(space, "the take-off point", {home, low}, clearance);
  if (pad_space == nullptr) return;
  check_climb(*pad_space, "the take-off point", {home, pad}, clearance);
  if (!options.returns) return;
  for (const Vector3d& rally : options.returns->rally) {
    const Vector3d top = rally + Vector3d(0.0, 0.0, options.takeoff_climb);
    const Vector3d above(rally.x(), rally.y(), std::min(top.z(), rally.z() + min));
    const std::string name = "the rally point " + position_text(rally);
    check_climb(space, name, {top, above}, clearance);
    check_climb(*pad_space, name, {top, rally}, clearance);
  }
}

}  // namespace skycap::flight
