/// A mission with a vehicle that is quick to survey.
#pragma once

#include <string>

namespace skycap::tests {

/// A teapot of 20 m, which takes a second to survey. Its spout and handle are what nobody sees from
/// the first view. The pad is so far away that DJI's vehicles, too, climb before they return from
/// behind it.
inline std::string flown_mission(const std::string& more = "") {
  return "scene: {model: 'builtin:teapot', longest_side: 20.0, ground: true}\n"
         "sensor: {width: 160, height: 120, max_range: 100, noise: {sigma: 0.02}}\n"
         "planner:\n"
         "  name: skycap\n"
         "  density: 1\n"
         "  resolution_radius: 1.2\n"
         "  spacing: 0.3\n"
         "  view_distance: 16\n"
         "  scene_box: {min: [-14, -11, 0.3], max: [14, 11, 13]}\n"
         "  least_gain: 0.02\n"
         "flight: {vehicle: generic, takeoff: [-75, 0, 0],\n"
         "         unknown_box: {min: [-14, -11, 0], max: [14, 11, 13]}}\n"
         "site: {latitude_deg: 47.1, longitude_deg: 8.2, ellipsoid_height: 480,\n"
         "       geoid_undulation: 48}\n"
         "evaluation: {registration_distance: 0.6, samples: 3000, visible_directions: 30,\n"
         "             ceiling_views: 0}\n"
         "limits: {max_views: 14}\n" +
         more;
}

}  // namespace skycap::tests
