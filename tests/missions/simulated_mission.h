/// Missions with a vehicle that are surveyed quickly.
#pragma once

#include <string>

namespace skycap::tests {

/// Returns a mission around a scene. Its surface and unknown space are in a box from `south_west`
/// to `north_east_top`. The exported mission has the survey's views in their shortest order. The
/// pad is so far away that DJI vehicles climb before they return from behind the scene.
inline std::string flight_mission_around(const std::string& scene, const std::string& south_west,
                                         const std::string& north_east_top) {
  return "scene: " + scene +
         "\n"
         "sensor: {width: 160, height: 120, max_range: 100, noise: {sigma: 0.02}}\n"
         "planner:\n"
         "  name: skycap\n"
         "  density: 1\n"
         "  resolution_radius: 1.2\n"
         "  spacing: 0.3\n"
         "  view_distance: 16\n"
         "  scene_box: {min: [" +
         south_west + ", 0.3], max: [" + north_east_top +
         "]}\n"
         "  min_gain: 0.02\n"
         "flight: {vehicle: generic, takeoff: [-75, 0, 0], views: survey,\n"
         "         unknown_box: {min: [" +
         south_west + ", 0], max: [" + north_east_top +
         "]}}\n"
         "site: {latitude_deg: 47.1, longitude_deg: 8.2, ellipsoid_height: 480,\n"
         "       geoid_undulation: 48}\n"
         "evaluation: {coverage_distance: 0.6, samples: 3000, visible_directions: 30,\n"
         "             attainable_views: 0}\n"
         "limits: {max_views: 14}\n";
}

/// Returns a mission with a teapot of 20 m, surveyed in 1 s. Its spout and handle are not visible
/// from the first view.
inline std::string flight_mission(const std::string& more = "") {
  return flight_mission_around("{model: 'builtin:teapot', longest_side: 20.0, ground: true}",
                               "-14, -11", "14, 11, 13") +
         more;
}

}  // namespace skycap::tests
