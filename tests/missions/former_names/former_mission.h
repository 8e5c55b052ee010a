/// A mission file of version 0.1.
#pragma once

#include <string>

namespace skycap::tests {

/// Mission of version 0.1 with all renamed keys and values, and with comments.
inline const std::string former_mission =
    "# A tower.  Its planner.least_gain stays in this comment.\n"
    "scene: {model: 'builtin:teapot', longest_side: 1.0}\n"
    "sensor: {width: 160, height: 100, noise: {sigma: 0.03}}\n"
    "planner:\n"
    "  name: skycap\n"
    "  wanted_coverage: 0.9   # least_gain: 0.5 is not it\n"
    "  'least_gain' : 0.01\n"
    "  ideas:\n"
    "    dose: true\n"
    "    batch: false\n"
    "  still_occluded: put_off  # put_off\n"
    "  scene_box: {min: [-3, -3, 0], max: [3, 3, 2]}\n"
    "evaluation: {registration_distance: 0.03, samples: 3000, visible_directions: 30,\n"
    "             ceiling_views: 0, radius: 0.1}\n"
    "limits: {max_views: 3, lowest_pitch_deg: -80, highest_pitch_deg: 80}\n"
    "site:\n"
    "  lowest_height: -5\n"
    "  highest_height: 40\n"
    "  no_fly:\n"
    "    - {corners: [[30, 30], [40, 30], [40, 40]], bottom: 0, top: 30}\n"
    "    - corners: [[-30, -30], [-40, -30], [-40, -40]]\n"
    "      bottom: -1\n"
    "      top: 3\n"
    "flight: {unknown_beside: [], free_without_return: 0, steepest_pad_deg: 9, temperature: 20,\n"
    "         opening: none, views: survey, style: stop}\n"
    "scan:\n"
    "  orbit: {radius: 25, lowest: 5, highest: 20}\n";

}  // namespace skycap::tests
