#include <cstdio>

#include "geometry/mesh.h"
#include "missions/mission_keys.h"
#include "missions/survey_scene.h"
#include "missions/verbs.h"

namespace skycap::missions {

int check(const CheckOptions& options, const Console& console) {
  const Mission mission = read_mission(options.mission, options.overrides);
  const geometry::Mesh model = placed_model(mission.scene, options.mission.parent_path());
  const survey::SeeConfig& see = mission.planner.see;
  const Eigen::Vector3d size = geometry::bounding_box(model).sizes();
  const double view_distance = see.view_distance.value_or(
      geometry::view_distance(geometry::Camera(mission.sensor.camera.camera), see.density));

  char text[640];
  std::snprintf(text, sizeof text,
                "%s: fine\n"
                "  scene     %zu triangles, %.4g x %.4g x %.4g m, %.4g m^2\n"
                "  planner   %s, view distance d %.4g m, spacing epsilon %.4g m, core threshold "
                "k %d\n",
                options.mission.c_str(), model.triangles.size(), size.x(), size.y(), size.z(),
                geometry::surface_area(model),
                to_text(*find_key("planner.name")->get(mission)).c_str(), view_distance,
                see.effective_spacing(), see.effective_core_threshold());
  console.out << text << std::flush;
  return 0;
}

}  // namespace skycap::missions
