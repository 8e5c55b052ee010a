#include <algorithm>
#include <cstdio>

#include "geometry/error.h"
#include "geometry/mesh.h"
#include "geometry/mesh_io.h"
#include "missions/model_store.h"
#include "missions/output_folder.h"
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

/// A model of the machine; obtained first if it is not there.
geometry::Mesh stored_model(const std::string& name, const Console& console) {
  try {
    return load_model("model:" + name, "");
  } catch (const Error&) {
    if (!contains(obtainable_models(), name)) throw;
  }
  const fs::path file = obtain_model(
      name, [&](const std::string& step) { console.err << "skycap: " << step << "\n"; });
  return load_model(fs::absolute(file).string(), "");
}

geometry::Mesh model_called(const std::string& name, const Console& console) {
  if (name.ends_with(".yaml") || name.ends_with(".yml")) {
    return placed_model(read_mission(name).scene, fs::path(name).parent_path());
  }
  if (name.find(':') != std::string::npos || fs::path(name).has_extension()) {
    return load_model(name, "");
  }
  if (contains(sim::models::model_names(), name)) return load_model("builtin:" + name, "");
  return stored_model(name, console);
}

}  // namespace

int model(const ModelOptions& options, const Console& console) {
  const geometry::Mesh mesh = model_called(options.name, console);
  if (options.out) {
    OutputFolder folder(options.out->has_parent_path() ? options.out->parent_path() : ".");
    geometry::write_mesh(folder.stage(options.out->filename().string()), mesh);
    folder.commit();
  }
  if (options.render) {
    OutputFolder folder(options.render->has_parent_path() ? options.render->parent_path() : ".");
    sim::render(mesh, folder.stage(options.render->filename().string()));
    folder.commit();
  }
  const Eigen::Vector3d size = geometry::bounding_box(mesh).sizes();
  char text[320];
  std::snprintf(text, sizeof text, "%s: %zu triangles, %.4g x %.4g x %.4g, area %.4g\n",
                options.name.c_str(), mesh.triangles.size(), size.x(), size.y(), size.z(),
                geometry::surface_area(mesh));
  console.out << text;
  return 0;
}

}  // namespace skycap::missions
