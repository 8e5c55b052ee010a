// Keys of the section `live`: processing of scans from external sensors.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {
namespace {

auto live(auto member) {
  return [member](auto& m) -> auto& { return m.live.*member; };
}

}  // namespace

std::vector<Key> live_keys() {
  return {
      boolean_key("live.pose_check", live(&online::LiveOptions::checks_poses),
                  "In a live survey, reject scans whose pose is inconsistent with the map, and "
                  "issue a warning."),
      number_key(
          "live.pose_sigma", "m", between(0, 100), live(&online::LiveOptions::pose_sigma),
          "Standard deviation of the position along each axis, for scans that do not specify it."),
      angle_key(
          "live.pose_sigma_deg", between(0, 90), live(&online::LiveOptions::pose_sigma_angle),
          "Standard deviation of the rotation about each axis, for scans that do not specify it."),
      boolean_key("live.registration", live(&online::LiveOptions::registers),
                  "Scan-to-map registration: correct the pose of each scan to fit the map, within "
                  "its standard deviations."),
      boolean_key("live.remove_flying_pixels", live(&online::LiveOptions::removes_flying_pixels),
                  "Remove flying pixels (between two surfaces) and isolated returns from scans "
                  "with pixels."),
  };
}

}  // namespace skycap::missions::config
