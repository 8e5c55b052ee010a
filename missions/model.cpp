#include <algorithm>
#include <cstdio>

#include "geometry/error.h"
#include "geometry/mesh.h"
#include "geometry/mesh_io.h"
#include "missions/model_store.h"
#include "missions/scene_source.h"
#include "missions/survey_scene.h"
#include "missions/verbs.h"
#include "sim/models/models.h"
#include "sim/render.h"

namespace skycap::missions {
namespace {

namespace fs = std::filesystem;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

geometry::Mesh mesh_of(const std::string& model) {
  SceneConfig scene;
  scene.model = model;
  return load_model(scene, "");
}

/// A model of the machine; obtained first if it is not there.
geometry::Mesh stored_model(const std::string& name, const Console& console) {
  if (contains(obtainable_models(), name) && !is_stored(name)) {
    obtain_model(name, [&](const std::string& step) { console.err << "skycap: " << step << "\n"; });
  }
  return mesh_of("model:" + name);
}

geometry::Mesh model_called(const std::string& name, const Console& console) {
  if (name.ends_with(".yaml") || name.ends_with(".yml")) {
    return placed_model(read_mission(name).scene, fs::path(name).parent_path());
  }
  if (name.find(':') != std::string::npos || fs::path(name).has_extension()) return mesh_of(name);
  const auto builtin = sim::builtin_models();
  if (std::ranges::find(builtin, name) != builtin.end()) return mesh_of("builtin:" + name);
  return stored_model(name, console);
}

}  // namespace

int model(const ModelOptions& options, const Console& console) {
  const geometry::Mesh mesh = model_called(options.name, console);
  if (options.out) geometry::write_mesh(*options.out, mesh);
  if (options.render) sim::write_png(sim::render(mesh), *options.render);
  const Eigen::Vector3d size = geometry::bounding_box(mesh).sizes();
  char text[320];
  std::snprintf(text, sizeof text, "%s: %zu triangles, %.4g x %.4g x %.4g, area %.4g\n",
                options.name.c_str(), mesh.triangles.size(), size.x(), size.y(), size.z(),
                geometry::surface_area(mesh));
  console.out << text;
  return 0;
}

}  // namespace skycap::missions
