#include "missions/report/scene_outline.h"

#include <cmath>
#include <string>

#include "flight/space/obstacles.h"
#include "missions/derived/mission_flight.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;

Json finite(double number) { return std::isfinite(number) ? Json(number) : Json(); }

Json volume(const char* role, const geometry::Prism& prism) {
  Json corners = Json::array();
  for (const Eigen::Vector2d& corner : prism.footprint) corners.push_back({corner.x(), corner.y()});
  return {{"role", role},
          {"name", prism.name},
          {"corners", corners},
          {"bottom", finite(prism.floor)},
          {"top", finite(prism.ceiling)}};
}

Json box(const char* role, const char* name, const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d& low = box.min();
  const Eigen::Vector3d& high = box.max();
  const geometry::Prism prism{.name = name,
                              .footprint = {{low.x(), low.y()},
                                            {high.x(), low.y()},
                                            {high.x(), high.y()},
                                            {low.x(), high.y()}},
                              .floor = low.z(),
                              .ceiling = high.z()};
  return volume(role, prism);
}

}  // namespace

Json scene_outline(const file::Mission& mission, const std::optional<Eigen::Vector3d>& pad) {
  const flight::Obstacles rules = derived::flight_rules(mission);
  Json volumes = Json::array();
  for (const geometry::Prism& prism : rules.no_fly) volumes.push_back(volume("no_fly", prism));
  // A fence of 100 km is the height limit alone.
  if (rules.fence && !mission.site.geofence.empty()) {
    volumes.push_back(volume("geofence", *rules.fence));
  }
  if (mission.flight.unknown_box) {
    volumes.push_back(box("unknown", "flight.unknown_box", *mission.flight.unknown_box));
  }
  if (mission.planner.see.scene_box) {
    volumes.push_back(box("scene", "planner.scene_box", *mission.planner.see.scene_box));
  }
  const geometry::CameraConfig& camera = mission.sensor.camera.camera;
  return {{"ground", mission.scene.position.z()},
          {"flown", mission.flight.is_flown()},
          {"pad", pad ? Json{pad->x(), pad->y(), pad->z()} : Json()},
          {"volumes", volumes},
          {"sensor",
           {{"horizontal_fov", camera.horizontal_fov},
            {"vertical_fov", camera.vertical_fov},
            {"lidar", mission.sensor.lidar.has_value()}}}};
}

}  // namespace skycap::missions::report
