#include "sim/models/models.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "geometry/error.h"
#include "sim/models/city_block.h"
#include "sim/models/families/families.h"
#include "sim/models/radcliffe_camera.h"
#include "sim/models/teapot.h"

namespace skycap::sim {
namespace {

using geometry::Mesh;

std::vector<std::string_view> list_family_names() {
  std::vector<std::string_view> names;
  for (const models::Family& family : models::families()) names.push_back(family.name);
  return names;
}

std::vector<std::string_view> list_model_names() {
  std::vector<std::string_view> names = list_family_names();
  names.insert(names.end(), {"city-block", "radcliffe-camera", "teapot"});
  std::ranges::sort(names);
  return names;
}

const models::Family* family_called(std::string_view name) {
  const auto families = models::families();
  const auto found = std::ranges::find(families, name, &models::Family::name);
  return found == families.end() ? nullptr : &*found;
}

/// Returns a level square sheet at z = 0, facing up.
Mesh ground(double side) {
  const double h = 0.5 * side;
  return {{{-h, -h, 0.0}, {h, -h, 0.0}, {h, h, 0.0}, {-h, h, 0.0}}, {{0, 1, 2}, {0, 2, 3}}};
}

/// Returns one of three values, according to the level of detail.
template <typename Value>
Value by_detail(LevelOfDetail detail, Value coarse, Value standard, Value fine) {
  switch (detail) {
    case LevelOfDetail::coarse:
      return coarse;
    case LevelOfDetail::standard:
      return standard;
    case LevelOfDetail::fine:
      return fine;
  }
  return standard;
}

models::Fineness fineness(LevelOfDetail detail) { return {by_detail(detail, 0.1, 0.004, 0.00033)}; }

Mesh city_block(const ModelOptions& options) {
  Mesh mesh = join(models::city_block({options.seed, fineness(options.detail)}));
  if (options.has_ground.value_or(true)) append(mesh, ground(220.0));
  return mesh;
}

Mesh radcliffe_camera(const ModelOptions& options) {
  models::RadcliffeOptions radcliffe;
  radcliffe.fineness = fineness(options.detail);
  radcliffe.has_fluted_columns = options.has_fluted_columns;
  Mesh mesh = join(models::radcliffe_camera(models::RadcliffeTable{}, radcliffe));
  if (options.has_ground.value_or(false)) append(mesh, ground(120.0));
  return mesh;
}

Mesh teapot(const ModelOptions& options) {
  Mesh mesh = models::teapot(by_detail(options.detail, 6, 16, 40));
  if (options.has_ground.value_or(false)) append(mesh, ground(20.0));
  return mesh;
}

models::FamilyScene family_scene(const models::Family& family, const ModelOptions& options) {
  geometry::RandomNumbers draw(options.seed);
  return family.make(draw, fineness(options.detail));
}

Mesh family_model(const models::Family& family, const ModelOptions& options) {
  Mesh mesh = join(family_scene(family, options).parts);
  if (options.has_ground.value_or(false)) append(mesh, ground(120.0));
  return mesh;
}

}  // namespace

std::span<const std::string_view> builtin_models() {
  static const std::vector<std::string_view> names = list_model_names();
  return names;
}

std::span<const std::string_view> model_families() {
  static const std::vector<std::string_view> names = list_family_names();
  return names;
}

bool is_drawn(std::string_view name) {
  return name == "city-block" || family_called(name) != nullptr;
}

std::vector<Surface> builtin_surfaces(std::string_view name, const ModelOptions& options) {
  const models::Family* const family = family_called(name);
  if (family == nullptr) return {};
  std::vector<Surface> surfaces;
  for (const models::Part& part : family_scene(*family, options).parts) {
    surfaces.insert(surfaces.end(), part.mesh.triangles.size(), part.surface);
  }
  const auto is_matt = [](Surface surface) { return surface == Surface::matt; };
  if (std::ranges::all_of(surfaces, is_matt)) return {};
  if (options.has_ground.value_or(false)) surfaces.insert(surfaces.end(), 2, Surface::matt);
  return surfaces;
}

Mesh builtin_model(std::string_view name, const ModelOptions& options) {
  if (name == "city-block") return city_block(options);
  if (name == "radcliffe-camera") return radcliffe_camera(options);
  if (name == "teapot") return teapot(options);
  if (const models::Family* family = family_called(name)) return family_model(*family, options);
  std::string known;
  for (const std::string_view each : builtin_models()) {
    known += (known.empty() ? "" : ", ") + std::string(each);
  }
  throw Error(ErrorKind::bad_config,
              "unknown builtin model '" + std::string(name) + "'; expected one of: " + known);
}

}  // namespace skycap::sim
