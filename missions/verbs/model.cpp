#include <algorithm>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/mesh_io.h"
#include "geometry/surfaces/mesh.h"
#include "missions/derived/resolved_mission.h"
#include "missions/file/mission_keys.h"
#include "missions/scene/model_store.h"
#include "missions/scene/scene_source.h"
#include "missions/scene/survey_scene.h"
#include "missions/verbs/verbs.h"
#include "sim/models/models.h"
#include "sim/scene/render.h"

namespace skycap::missions::verbs {
namespace {

namespace fs = std::filesystem;

bool contains(const auto& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

geometry::Mesh mesh_of(const std::string& model, const std::optional<std::string>& detail) {
  file::Mission mission;
  mission.scene.model = model;
  if (detail) {
    if (!model.starts_with("builtin:")) {
      throw Error(ErrorKind::bad_config,
                  "--detail needs a builtin model; " + model + " is as detailed as its file");
    }
    file::find_key("scene.detail")->set(mission, *detail);
  }
  return scene::load_model(mission.scene, "");
}

void obtain_if_missing(const std::string& name, const Console& console) {
  if (contains(scene::obtainable_models(), name) && !scene::is_stored(name)) {
    scene::obtain_model(
        name, [&](const std::string& step) { console.err << "skycap: " << step << "\n"; });
  }
}

geometry::Mesh model_called(const ModelOptions& options, const Console& console) {
  const std::string& name = options.name;
  if (name.ends_with(".yaml") || name.ends_with(".yml")) {
    std::vector<file::KeyOverride> overrides;
    if (options.detail) overrides.push_back({"--detail", "scene.detail", *options.detail});
    return scene::placed_model(derived::read_mission(name, overrides),
                               fs::path(name).parent_path());
  }
  if (name.find(':') != std::string::npos || fs::path(name).has_extension()) {
    return mesh_of(name, options.detail);
  }
  if (contains(sim::builtin_models(), name)) return mesh_of("builtin:" + name, options.detail);
  obtain_if_missing(name, console);
  return mesh_of("model:" + name, options.detail);
}

}  // namespace

int model(const ModelOptions& options, const Console& console) {
  ProgressLine progress(console, false);
  progress.show(options.name + ": making the model ready");
  const geometry::Mesh mesh = model_called(options, console);
  progress.clear();
  if (options.out) geometry::write_mesh(*options.out, mesh);
  if (options.render) sim::write_png(sim::render(mesh), *options.render);
  const Eigen::Vector3d size = geometry::bounding_box(mesh).sizes();
  console.out << fmt::format("{}: {} triangles, {:.4g} x {:.4g} x {:.4g}, area {:.4g}\n",
                             options.name, mesh.triangles.size(), size.x(), size.y(), size.z(),
                             geometry::surface_area(mesh));
  return 0;
}

}  // namespace skycap::missions::verbs
