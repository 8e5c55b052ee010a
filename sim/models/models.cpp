#include "sim/models/models.h"

#include <array>
#include <cmath>
#include <string>

#include "geometry/error.h"
#include "sim/models/city_block.h"
#include "sim/models/radcliffe_camera.h"
#include "sim/models/teapot.h"

namespace skycap::sim {
namespace {

using geometry::Mesh;

constexpr std::array<std::string_view, 3> names{"city-block", "radcliffe-camera", "teapot"};

/// A level square sheet at z = 0, facing up.
Mesh ground(double side) {
  const double h = 0.5 * side;
  return {{{-h, -h, 0.0}, {h, -h, 0.0}, {h, h, 0.0}, {-h, h, 0.0}}, {{0, 1, 2}, {0, 2, 3}}};
}

/// One choice out of three, by the level of detail.
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

}  // namespace

std::span<const std::string_view> builtin_models() { return names; }

Mesh builtin_model(std::string_view name, const ModelOptions& options) {
  if (name == "city-block") return city_block(options);
  if (name == "radcliffe-camera") return radcliffe_camera(options);
  if (name == "teapot") return teapot(options);
  std::string known;
  for (const std::string_view each : names) {
    known += (known.empty() ? "" : ", ") + std::string(each);
  }
  throw Error(ErrorKind::bad_config, "there is no built-in model named '" + std::string(name) +
                                         "'; it must be one of: " + known);
}

}  // namespace skycap::sim
