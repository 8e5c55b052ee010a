/// Procedural scenes that Skycap can generate.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "geometry/surfaces/mesh.h"
#include "sim/scene/surface.h"

namespace skycap::sim {

/// Tessellation density of a model. The shape remains the same.
enum class LevelOfDetail {
  coarse,    ///< For quick trials: about 50,000 triangles for the Radcliffe Camera.
  standard,  ///< About 500,000 triangles.
  fine,      ///< About 3,000,000 triangles.
};

struct ModelOptions {
  LevelOfDetail detail = LevelOfDetail::standard;
  /// Adds a level square of ground at z = 0, as a single sheet of triangles facing up. Default:
  /// only for the city block.
  std::optional<bool> has_ground;
  std::uint64_t seed = 1;           ///< Seed of random models.
  bool has_fluted_columns = false;  ///< radcliffe-camera: fluted instead of plain shafts.
};

/// Returns the names that builtin_model() accepts, in alphabetical order.
std::span<const std::string_view> builtin_models();

/// Returns the names of random models, which expose weaknesses of planners, in alphabetical order.
/// They are the families of sim/models/families/families.h.
std::span<const std::string_view> model_families();

/// Returns true if the model of that name depends on ModelOptions::seed.
bool is_drawn(std::string_view name);

/// Returns the model of that name in metres, z up, on z = 0 around the origin:
///   city-block: buildings around courtyards, about 200 m x 200 m;
///   radcliffe-camera: the Radcliffe Camera, Oxford, 40 m high;
///   teapot: Newell's teapot in its own units, 6.434 long, to be scaled;
///   and one of model_families().
///
/// Buildings are sets of closed, outward-facing solids that overlap where they meet. A ray from
/// outside meets front faces only. Deterministic: equal arguments give bit-identical meshes.
///
/// Throws Error{bad_config} with the list of names if the name is unknown.
geometry::Mesh builtin_model(std::string_view name, const ModelOptions& options = {});

/// Returns the surface types of the model's triangles. Empty if all are matt.
std::vector<Surface> builtin_surfaces(std::string_view name, const ModelOptions& options = {});

}  // namespace skycap::sim
