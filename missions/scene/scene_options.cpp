#include "missions/scene/scene_options.h"

#include <map>

#include "missions/site_data/site_priors.h"

namespace skycap::missions::scene {

using site_data::Role;

geometry::Mesh prior_truth(const SceneOptions& scene) {
  if (!scene.truth || !scene.priors) return {};
  return make_surfaces(*scene.priors, *scene.truth);
}

std::vector<const geometry::Mesh*> find_neighbours(const site_data::SitePriors& site) {
  std::map<std::string, const geometry::Mesh*> surveyed;
  std::vector<const geometry::Mesh*> neighbours;
  const auto visit = [&](auto tile_filter, auto&& visit_object) {
    for (std::size_t i = 0; i < site.priors.size(); ++i) {
      if (!tile_filter(site.sources[i].role)) continue;
      for (const site_data::Object& object : site.priors[i].objects) visit_object(object);
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

geometry::Mesh prior_neighbours(const SceneOptions& scene) {
  geometry::Mesh mesh;
  if (!scene.neighbours || !scene.priors) return mesh;
  for (const geometry::Mesh* neighbour : find_neighbours(*scene.priors)) {
    geometry::append(mesh, *neighbour);
  }
  return mesh;
}

}  // namespace skycap::missions::scene
