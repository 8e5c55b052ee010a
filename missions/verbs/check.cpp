#include <algorithm>

#include <fmt/format.h>

#include "flight/export/export.h"
#include "flight/paths/path.h"
#include "flight/route/route.h"
#include "geometry/surfaces/mesh.h"
#include "missions/derived/mission_flight.h"
#include "missions/derived/resolved_mission.h"
#include "missions/file/number_text.h"
#include "missions/file/planner_titles.h"
#include "missions/scene/survey_scene.h"
#include "missions/verbs/check_returns.h"
#include "missions/verbs/verbs.h"

namespace skycap::missions::verbs {
namespace {

/// Proves a route file's legs against the mission's scene as it truly is.
int check_route_file(const CheckOptions& options, const file::Mission& mission,
                     const geometry::Mesh& model, const Console& console) {
  const std::filesystem::path& file = *options.route;
  // Heights above take-off count from the pad's; where on the ground it is does not matter.
  const Eigen::Vector3d pad = derived::pad_of(mission, mission.scene.position);
  const std::vector<Eigen::Vector3d> points =
      flight::read_route(file, derived::site_of(mission), pad);
  flight::Obstacles obstacles = derived::flight_rules(mission);
  obstacles.mesh = model;
  const flight::KnownSpace space(obstacles);

  const double asked_for = mission.flight.clearance;
  const double clearance = std::max(0.0, asked_for - flight::rounding_bound);
  const auto violations = flight::check_route(points, space, clearance);
  for (const flight::Violation& violation : violations) {
    console.out << file.string() << ": " << flight::describe(violation) << "\n";
  }
  double least = asked_for + flight::reported_surplus;
  for (std::size_t i = 1; i < points.size(); ++i) {
    least = std::min(least, space.closest({points[i - 1], points[i]}, least).distance);
  }
  console.out << file.string() << ": " << (violations.empty() ? "fine" : "not safe") << ", "
              << violations.size() << " of " << std::max<std::size_t>(points.size(), 2) - 1
              << " legs come nearer than " << file::short_text(asked_for) << " m, the nearest "
              << file::short_text(least) << " m; " << file::short_text(flight::length(points))
              << " m long\n";
  const ReturnCheck returns = check_returns(file, options.return_height, mission, space, points);
  console.out << file.string() << ": " << returns.text << "\n" << std::flush;
  return violations.empty() && returns.is_safe ? 0 : 1;
}

}  // namespace

int check(const CheckOptions& options, const Console& console) {
  const file::Mission mission = derived::read_mission(options.mission, options.overrides);
  const geometry::Mesh model = scene::placed_model(mission.scene, options.mission.parent_path());
  if (options.route) return check_route_file(options, mission, model, console);
  const survey::see::SeeConfig& see = mission.planner.see;
  const Eigen::Vector3d size = geometry::bounding_box(model).sizes();
  const double view_distance = see.view_distance.value_or(
      geometry::view_distance(geometry::Camera(mission.sensor.camera.camera), see.density));

  console.out << fmt::format(
                     "{}: fine\n"
                     "  scene     {} triangles, {:.4g} x {:.4g} x {:.4g} m, {:.4g} m^2\n"
                     "  planner   {}, view distance d {:.4g} m, spacing epsilon {:.4g} m, core "
                     "threshold k {}\n",
                     options.mission.string(), model.triangles.size(), size.x(), size.y(), size.z(),
                     geometry::surface_area(model), file::title_of(mission.planner.name).word,
                     view_distance, see.effective_spacing(), see.effective_core_threshold())
              << std::flush;
  return 0;
}

}  // namespace skycap::missions::verbs
