#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/mesh_io.h"
#include "geometry/surfaces/mesh.h"
#include "missions/cli/command_options.h"
#include "missions/cli/commands.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/scene/model_store.h"
#include "missions/scene/scene_source.h"
#include "sim/models/models.h"
#include "sim/scene/render.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

bool contains(const auto& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

sim::LevelOfDetail level_of_detail(const std::string& word) {
  if (word == "coarse") return sim::LevelOfDetail::coarse;
  return word == "fine" ? sim::LevelOfDetail::fine : sim::LevelOfDetail::standard;
}

geometry::Mesh make_mesh(const std::string& model, const std::optional<std::string>& detail) {
  scene::SceneOptions scene{.model = model};
  if (detail) {
    if (!model.starts_with("builtin:")) {
      throw Error(ErrorKind::bad_config,
                  "--detail requires a builtin model; " + model + " has a fixed level of detail");
    }
    scene.detail = level_of_detail(*detail);
  }
  return scene::load_model(scene, "");
}

void obtain_if_missing(const std::string& name, const Console& console) {
  if (contains(scene::obtainable_models(), name) && !scene::is_stored(name)) {
    scene::obtain_model(
        name, [&](const std::string& step) { console.err << "skycap: " << step << "\n"; });
  }
}

/// Scene in a sandstone colour, with prior data in the colours of its roles.
struct ColouredMesh {
  geometry::Mesh mesh;
  std::vector<Eigen::Vector3f> colours;  ///< colours of the triangles; empty: sandstone

  void add(const geometry::Mesh& more, const Eigen::Vector3f& colour) {
    geometry::append(mesh, more);
    colours.resize(mesh.triangles.size(), colour);
  }
};

/// Scene of a mission with its simulated model, which is empty for live surveys.
struct Site {
  scene::SceneOptions scene;
  geometry::Mesh model;
};

/// Returns the targets' box, enlarged on each side by its longest edge, because a map tile may
/// contain a whole town.
std::optional<Eigen::AlignedBox3d> around_targets(const site_data::SitePriors& site) {
  const geometry::Mesh targets = make_surfaces(site, site_data::Role::target);
  if (targets.triangles.empty()) return std::nullopt;
  const Eigen::AlignedBox3d box = geometry::bounding_box(targets);
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(box.sizes().maxCoeff());
  return Eigen::AlignedBox3d(box.min() - reach, box.max() + reach);
}

/// Returns the site without the objects of obstacles that are also targets or ground truth.
site_data::SitePriors without_repeated_objects(const site_data::SitePriors& site) {
  const std::vector<const geometry::Mesh*> neighbours = scene::find_neighbours(site);
  site_data::SitePriors others = site;
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role != site_data::Role::obstacle) continue;
    others.priors[i].objects.clear();
    for (const site_data::Object& object : site.priors[i].objects) {
      if (std::ranges::find(neighbours, &object.mesh) != neighbours.end()) {
        others.priors[i].objects.push_back(object);
      }
    }
  }
  return others;
}

/// Returns the whole site, or its objects near a box.
ColouredMesh coloured_site(const Site& given, const std::optional<Eigen::AlignedBox3d>& near) {
  const auto& [scene, model] = given;
  if (!scene.priors) return {model, {}};
  const site_data::SitePriors site = without_repeated_objects(*scene.priors);
  ColouredMesh coloured;
  if (!scene.is_truth_prior()) coloured.add(model, {0.80F, 0.71F, 0.55F});
  coloured.add(make_surfaces(site, site_data::Role::truth, near), {0.62F, 0.68F, 0.75F});
  coloured.add(make_surfaces(site, site_data::Role::target, near), {0.20F, 0.55F, 0.30F});
  coloured.add(make_surfaces(site, site_data::Role::obstacle, near), {0.75F, 0.28F, 0.12F});
  coloured.add(make_surfaces(site, site_data::Role::terrain, near), {0.42F, 0.38F, 0.26F});
  return coloured;
}

bool is_mission(const std::string& name) {
  return name.ends_with(".yaml") || name.ends_with(".yml");
}

Site site_called(const ModelOptions& options, const config::Report& report) {
  std::vector<config::KeyOverride> overrides;
  if (options.detail) overrides.push_back({"--detail", "scene.detail", *options.detail});
  config::MissionSetup setup = config::read_live_mission(options.name, overrides, report);
  if (!setup.scene().priors) setup = config::read_mission(options.name, overrides);
  if (setup.is_live()) return {setup.scene(), {}};
  return {setup.scene(),
          evaluation::placed_model(setup.scene(), fs::path(options.name).parent_path())};
}

geometry::Mesh model_called(const ModelOptions& options, const Console& console) {
  const std::string& name = options.name;
  if (name.find(':') != std::string::npos || fs::path(name).has_extension()) {
    return make_mesh(name, options.detail);
  }
  if (contains(sim::builtin_models(), name)) return make_mesh("builtin:" + name, options.detail);
  obtain_if_missing(name, console);
  return make_mesh("model:" + name, options.detail);
}

}  // namespace

int model(const ModelOptions& options, const Console& console) {
  ProgressLine progress(console, false);
  progress.show(options.name + ": loading the model");
  std::optional<Site> site;
  if (is_mission(options.name)) site = site_called(options, progress.progress_callback());
  const ColouredMesh whole =
      site ? coloured_site(*site, {}) : ColouredMesh{model_called(options, console), {}};
  const geometry::Mesh& mesh = whole.mesh;
  geometry::validate(mesh);
  if (options.out) {
    progress.show("writing " + options.out->string());
    geometry::write_mesh(*options.out, mesh);
  }
  if (options.render) {
    const bool has_priors = site && site->scene.priors;
    const auto near = has_priors ? around_targets(*site->scene.priors) : std::nullopt;
    const ColouredMesh shown = near ? coloured_site(*site, near) : whole;
    sim::RenderOptions render;
    render.colours = shown.colours;
    render.report = [&](double share) {
      progress.show(fmt::format("{}: {:.0f}% of the image", options.name, 100.0 * share));
    };
    sim::write_png(sim::render(shown.mesh, render), *options.render);
  }
  progress.clear();
  const Eigen::Vector3d size = geometry::bounding_box(mesh).sizes();
  console.out << fmt::format("{}: {} triangles, {:.4g} x {:.4g} x {:.4g}, area {:.4g}\n",
                             options.name, mesh.triangles.size(), size.x(), size.y(), size.z(),
                             geometry::surface_area(mesh));
  return 0;
}

void add_model(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand("model", "Download, export or render a scene model");
  const auto options = std::make_shared<ModelOptions>();
  command
      ->add_option(
          "name", options->name,
          "Model: teapot, bunny, dragon, radcliffe-camera, ..., a mesh file or a mission file")
      ->required();
  command->add_option("--out", options->out, "Write the mesh to this PLY file");
  command
      ->add_option("--detail", options->detail,
                   "Level of detail of a builtin model: coarse, standard or fine")
      ->check(CLI::IsMember({"coarse", "standard", "fine"}));
  command->add_option("--render", options->render, "Render the model into this PNG file");
  run(*command, options, model, console, action);
}

}  // namespace skycap::missions::cli
