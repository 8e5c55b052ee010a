#include "missions/config/mission_priors.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "geometry/place/camera.h"
#include "missions/config/mission_flight.h"
#include "missions/config/mission_keys.h"
#include "missions/config/site.h"
#include "missions/site_data/surface_points.h"

namespace skycap::missions::config {
namespace {

using site_data::Role;
using site_data::Source;

std::string key_of(std::size_t source, const std::string& key) {
  return "prior[" + std::to_string(source) + "]." + key;
}

/// scene.model of a mission whose targets stand in as truth.
constexpr const char* targets_as_truth = "prior";

/// How far beside its place on a map a target is looked for, unless it may be off by more [m].
constexpr double most_beside_targets = 3.0;

/// Of one object, for the planner to guess by.
constexpr std::size_t most_target_points = 300'000;

/// A path counts from the mission's folder.
void make_absolute(std::filesystem::path& path, const std::filesystem::path& folder) {
  if (path.empty()) return;
  path = std::filesystem::absolute(folder / path);
}

void check_source(const config::MissionFile& given, std::size_t i) {
  const config::Mission& mission = given.mission;
  const Source& source = mission.prior[i];
  if (source.place && !source.crs.empty()) {
    given.refuse(key_of(i, "crs"), "excludes place; a file is put by one of the two");
  }
  if (!source.crs.empty() && !has_place(mission)) {
    given.refuse(key_of(i, "crs"),
                 "needs the place of the mission's frame; give site.latitude_deg and "
                 "site.longitude_deg");
  }
  if (source.base_on_terrain && source.role == Role::terrain) {
    given.refuse(key_of(i, "base"), "of the terrain cannot be the terrain; give a number");
  }
  if (source.role == Role::truth && !mission.scene.model.empty()) {
    given.refuse(key_of(i, "role"),
                 "of truth takes the place of scene.model; leave one of the two out");
  }
}

bool has_role(const config::Mission& mission, Role role) {
  return std::ranges::find(mission.prior, role, &Source::role) != mission.prior.end();
}

/// What a package kept of a mission gives every key, most of them as they are by default.
bool differs_from_default(const config::Mission& mission, const char* path) {
  const config::Key& key = *config::find_key(path);
  const auto text = [&](const config::Mission& given) {
    const auto value = key.get(given);
    return value ? config::to_text(*value) : std::string();
  };
  return text(mission) != text(config::Mission());
}

/// What is truth has to have surfaces, and is where its file says.
void check_truth(const config::MissionFile& given) {
  const config::Mission& mission = given.mission;
  if (!is_truth_prior(mission)) return;
  if (prior_truth(mission).triangles.empty()) {
    given.refuse("scene.model", "is prior data, but no target or truth among it has a surface");
  }
  for (const char* key : {"scene.up_axis", "scene.rotation_deg", "scene.longest_side",
                          "scene.scale", "scene.copies", "scene.materials"}) {
    if (differs_from_default(mission, key)) {
      given.refuse(key,
                   "does not go with a truth from prior data, which is "
                   "placed by its own keys; leave it out");
    }
  }
}

/// The surfaces of things in the way but for those that are targets or the truth as well. Files
/// that hold a target mostly hold what stands around it, and are read once for each role.
std::vector<const geometry::Mesh*> neighbours_of(const site_data::SitePriors& site) {
  std::map<std::string, const geometry::Mesh*> surveyed;
  std::vector<const geometry::Mesh*> neighbours;
  const auto visit = [&](auto is_wanted, auto&& take) {
    for (std::size_t i = 0; i < site.priors.size(); ++i) {
      if (!is_wanted(site.sources[i].role)) continue;
      for (const site_data::Object& object : site.priors[i].objects) take(object);
    }
  };
  visit([](Role role) { return role == Role::target || role == Role::truth; },
        [&](const site_data::Object& object) { surveyed[object.id] = &object.mesh; });
  visit([](Role role) { return role == Role::obstacle; },
        [&](const site_data::Object& object) {
          const auto same = surveyed.find(object.id);
          if (same != surveyed.end() && same->second->vertices == object.mesh.vertices) return;
          if (site_data::has_area(object.mesh)) neighbours.push_back(&object.mesh);
        });
  return neighbours;
}

/// So far beside targets their surface is looked for: not where neighbours are that the sensor will
/// see.
double beside_targets_of(const config::Mission& mission, const Eigen::AlignedBox3d& targets) {
  double beside = most_beside_targets;
  if (mission.scene.neighbours || mission.scene.model.empty()) {
    for (const geometry::Mesh* neighbour : neighbours_of(priors_of(mission))) {
      beside = std::min(beside, 0.5 * targets.exteriorDistance(geometry::bounding_box(*neighbour)));
    }
  }
  for (std::size_t i = 0; i < priors_of(mission).priors.size(); ++i) {
    if (priors_of(mission).sources[i].role != Role::target) continue;
    beside = std::max(beside, priors_of(mission).priors[i].uncertainty);
  }
  return beside;
}

site_data::SiteFrame frame_of(const config::Mission& mission) {
  site_data::SiteFrame frame{.ground_z = mission.scene.position.z(),
                             .undulation = mission.georeference.geoid_undulation};
  if (mission.flight.takeoff) {
    frame.takeoff_z = mission.flight.takeoff->z();
    frame.ground_z = *frame.takeoff_z;
  }
  if (has_place(mission)) frame.origin = site_of(mission).origin;
  return frame;
}

}  // namespace

void read_priors(config::MissionFile& given, const Report& report) {
  config::Mission& mission = given.mission;
  if (mission.prior.empty()) return;
  const std::filesystem::path folder = std::filesystem::path(given.name).parent_path();
  for (std::size_t i = 0; i < mission.prior.size(); ++i) {
    Source& source = mission.prior[i];
    make_absolute(source.file, folder);
    make_absolute(source.select.within, folder);
    check_source(given, i);
  }
  const auto failed = [&](std::size_t i, const std::string& what) {
    given.refuse(key_of(i, "file"), what);
  };
  std::size_t begun = 0;
  const auto reading = [&](std::size_t i) {
    if (!report) return;
    report("reading file " + std::to_string(++begun) + " of " +
           std::to_string(mission.prior.size()) + " of prior data, " +
           mission.prior[i].file.filename().string());
  };
  mission.priors = std::make_shared<const site_data::SitePriors>(
      site_data::read_site_priors(mission.prior, frame_of(mission), failed, reading));
  check_truth(given);
}

void derive_scene_box(config::Mission& mission) {
  survey::see::SeeConfig& see = mission.planner.see;
  if (see.scene_box) return;
  const geometry::Mesh targets = surfaces_of(priors_of(mission), Role::target);
  if (targets.triangles.empty()) return;
  Eigen::AlignedBox3d box = geometry::bounding_box(targets);
  const double beside = beside_targets_of(mission, box);
  box.min().array() -= beside;
  box.max().array() += beside;
  if (mission.scene.ground || mission.flight.is_flown()) {
    // The ground is no target: what is so near to it counts as the ground.
    const double ground =
        mission.scene.position.z() + 2.0 * mission.evaluation.registration_distance;
    if (ground < box.max().z()) box.min().z() = std::max(box.min().z(), ground);
  }
  see.scene_box = box;
}

double ground_height_of(const config::Mission& mission) {
  const site_data::SitePriors& site = priors_of(mission);
  double height = mission.scene.position.z();
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    const site_data::Prior& known = site.priors[i];
    if (site.sources[i].role != Role::terrain) continue;
    height = std::min(height, known.box.min().z() - known.uncertainty);
  }
  return height;
}

double ground_at(const config::Mission& mission, const Eigen::Vector2d& place) {
  const site_data::TerrainHeight& ground = priors_of(mission).ground;
  return ground ? ground(place).value() : mission.scene.position.z();
}

bool is_truth_prior(const config::Mission& mission) {
  return mission.scene.model == targets_as_truth ||
         (mission.scene.model.empty() && has_role(mission, Role::truth));
}

geometry::Mesh prior_truth(const config::Mission& mission) {
  if (!is_truth_prior(mission)) return {};
  const bool is_target = mission.scene.model == targets_as_truth;
  return surfaces_of(priors_of(mission), is_target ? Role::target : Role::truth);
}

bool has_target(const config::Mission& mission) { return has_role(mission, Role::target); }

bool has_obstacle(const config::Mission& mission) { return has_role(mission, Role::obstacle); }

geometry::Mesh prior_neighbours(const config::Mission& mission) {
  geometry::Mesh mesh;
  if (!mission.scene.neighbours) return mesh;
  for (const geometry::Mesh* neighbour : neighbours_of(priors_of(mission))) {
    geometry::append(mesh, *neighbour);
  }
  return mesh;
}

std::shared_ptr<const survey::skycap::PriorSurface> prior_surface(const config::Mission& mission) {
  const site_data::SitePriors& site = priors_of(mission);
  auto surface = std::make_shared<survey::skycap::PriorSurface>();
  // Four pixels are the finest resolution of the planner: a point each is enough.
  const geometry::Camera camera(mission.sensor.camera.camera);
  const double pixel = view_distance_of(mission) / camera.focal_length_px().minCoeff();
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role != Role::target) continue;
    for (const site_data::Object& object : site.priors[i].objects) {
      const site_data::SurfacePoints points =
          site_data::spread_over(object, most_target_points, 2.0 * pixel);
      surface->positions.insert(surface->positions.end(), points.positions.begin(),
                                points.positions.end());
      surface->normals.insert(surface->normals.end(), points.normals.begin(), points.normals.end());
      surface->areas.resize(surface->positions.size(), static_cast<float>(points.area_of_each));
      surface->uncertainties.resize(surface->positions.size(),
                                    static_cast<float>(site.priors[i].uncertainty));
    }
  }
  return surface->size() > 0 ? surface : nullptr;
}

const site_data::SitePriors& priors_of(const config::Mission& mission) {
  static const site_data::SitePriors none;
  return mission.priors ? *mission.priors : none;
}

}  // namespace skycap::missions::config
