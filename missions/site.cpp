#include "missions/site.h"

#include <algorithm>

namespace skycap::missions {

survey::ViewLimits view_limits(const Mission& mission) {
  const LimitsConfig& limits = mission.limits;
  survey::ViewLimits result{.least_height = mission.site.lowest_height,
                            .most_height = mission.site.highest_height,
                            .geofence = mission.site.geofence,
                            .no_fly = mission.site.no_fly,
                            .stand_off = limits.stand_off,
                            .least_pitch = limits.lowest_pitch,
                            .most_pitch = limits.highest_pitch};
  if (limits.ground_clearance) {
    const double least = mission.scene.position.z() + *limits.ground_clearance;
    result.least_height = std::max(least, result.least_height.value_or(least));
  }
  return result;
}

}  // namespace skycap::missions
