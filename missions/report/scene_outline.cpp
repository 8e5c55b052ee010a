#include "missions/report/scene_outline.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "flight/clearance/obstacles.h"
#include "missions/package/settings.h"
#include "missions/site_data/prior_text.h"
#include "missions/site_data/site_priors.h"
#include "missions/site_data/terrain.h"
#include "missions/support/json_text.h"

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

/// The corners of a prior's triangles, to a centimetre; none of too many to be shown. Objects of
/// `drawn` are left out: they are drawn as targets.
Json surface(const site_data::Source& source, const site_data::Prior& prior,
             const std::set<const geometry::Mesh*>& drawn) {
  constexpr std::size_t max_triangles = 20'000;
  geometry::Mesh mesh;
  for (const site_data::Object& object : prior.objects) {
    if (!drawn.contains(&object.mesh)) geometry::append(mesh, object.mesh);
  }
  if (prior.grid.rows > 0) {
    const std::size_t cells = prior.grid.rows * prior.grid.columns;
    const auto step = static_cast<std::size_t>(
        std::max(1.0, std::ceil(std::sqrt(2.0 * static_cast<double>(cells) / max_triangles))));
    geometry::append(
        mesh,
        site_data::make_mesh(to_triangles(step > 1 ? downsampled(prior.grid, step) : prior.grid)));
  }
  Json corners = Json::array();
  if (mesh.triangles.size() <= max_triangles) {
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle) {
        for (const double coordinate : mesh.vertices[vertex]) {
          corners.push_back(std::round(100.0 * coordinate) / 100.0);
        }
      }
    }
  }
  return {{"role", site_data::to_string(source.role)},
          {"name", source.file.filename().string()},
          {"corners", corners}};
}

/// Objects with the role obstacle that are targets, too: the same file has both roles.
std::set<const geometry::Mesh*> targets_among_obstacles(const site_data::SitePriors& site) {
  std::set<const geometry::Mesh*> meshes;
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role != site_data::Role::obstacle) continue;
    for (const site_data::Object& object : site.priors[i].objects) meshes.insert(&object.mesh);
  }
  for (const geometry::Mesh* neighbour : scene::find_neighbours(site)) meshes.erase(neighbour);
  return meshes;
}

}  // namespace

Json scene_outline(const session::SurveyOptions& survey, const scene::SceneOptions& scene,
                   const std::optional<Eigen::Vector3d>& pad) {
  const flight::FlightOptions& flight = survey.flight;
  const flight::Obstacles rules = flight.rules();
  Json volumes = Json::array();
  for (const geometry::Prism& prism : rules.no_fly) volumes.push_back(volume("no_fly", prism));
  // Without a geofence, the fence is a placeholder of 100 km that represents only the height limit.
  if (rules.fence && !flight.airspace.geofence.empty()) {
    volumes.push_back(volume("geofence", *rules.fence));
  }
  if (flight.has_own_box) {
    volumes.push_back(box("unknown", "flight.unknown_box", flight.unknown_box));
  }
  if (survey.planner.scene_box) {
    volumes.push_back(box("scene", "planner.scene_box", *survey.planner.scene_box));
  }
  Json priors = Json::array();
  std::set<const geometry::Mesh*> drawn;
  if (scene.priors) drawn = targets_among_obstacles(*scene.priors);
  for (std::size_t i = 0; scene.priors && i < scene.priors->priors.size(); ++i) {
    priors.push_back(surface(scene.priors->sources[i], scene.priors->priors[i], drawn));
  }
  const geometry::CameraConfig& camera = flight.capture.camera;
  Json outline{{"ground", scene.position.z()},
               {"flown", flight.has_vehicle()},
               {"pad", pad ? Json{pad->x(), pad->y(), pad->z()} : Json()},
               {"volumes", volumes},
               {"sensor",
                {{"horizontal_fov", camera.horizontal_fov},
                 {"vertical_fov", camera.vertical_fov},
                 {"lidar", flight.capture.is_scanner}}}};
  if (!priors.empty()) outline["priors"] = std::move(priors);
  return outline;
}

Json scene_outline(const Json& summary, const std::string& name) {
  const config::MissionSetup setup = package::mission_from_settings(summary.at("settings"), name);
  std::optional<Eigen::Vector3d> pad;
  if (const Json::json_pointer at("/flight/pad"); summary.contains(at)) {
    pad = support::to_vector(summary.at(at));
  }
  return scene_outline(setup.survey(), setup.scene(), pad);
}

}  // namespace skycap::missions::report
