// The keys of `live`: what is made of scans that come from outside.
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
                  "Whether a scan of a live survey that does not fit what is known at its pose is "
                  "set aside, with a warning, and not used."),
      number_key("live.pose_sigma", "m", between(0, 100), live(&online::LiveOptions::pose_sigma),
                 "How far off poses are, along each axis, where the scan itself does not say: one "
                 "standard deviation."),
      angle_key("live.pose_sigma_deg", between(0, 90), live(&online::LiveOptions::pose_sigma_angle),
                "How far they are turned about each axis, where the scan itself does not say."),
      boolean_key("live.registration", live(&online::LiveOptions::registers),
                  "Whether each scan's pose is corrected so that it fits what is known, as far as "
                  "its sigma allows."),
      boolean_key("live.remove_flying_pixels", live(&online::LiveOptions::removes_flying_pixels),
                  "Whether pixels between two surfaces and isolated returns are left out of scans "
                  "with pixels."),
  };
}

}  // namespace skycap::missions::config
