/// The scenes that Skycap can make by itself.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "geometry/surfaces/mesh.h"
#include "sim/scene/surface.h"

namespace skycap::sim {

/// How finely a model is cut into triangles; the shape stays the same.
enum class LevelOfDetail {
  coarse,    ///< for quick trials: the Radcliffe Camera in about 50,000 triangles
  standard,  ///< half a million
  fine,      ///< three million
};

struct ModelOptions {
  LevelOfDetail detail = LevelOfDetail::standard;
  /// Whether the model stands on a level square of ground at z = 0, which is a single sheet of
  /// triangles facing up. Nothing: as usual for the model, the city block with, the others without.
  std::optional<bool> has_ground;
  std::uint64_t seed = 1;           ///< of models that are drawn: which of them
  bool has_fluted_columns = false;  ///< radcliffe-camera: with fluted shafts instead of plain ones
};

/// The names that builtin_model() knows, in alphabetical order.
std::span<const std::string_view> builtin_models();

/// Those of them that are drawn from ModelOptions::seed to find planners' weaknesses: the families
/// of sim/models/families/families.h, in alphabetical order.
std::span<const std::string_view> model_families();

/// Whether the model of that name depends on ModelOptions::seed.
bool is_drawn(std::string_view name);

/// The model of that name, in metres, z up, standing on z = 0 around the origin:
///   city-block        9 to 16 buildings round courtyards, about 200 m x 200 m
///   radcliffe-camera  the Radcliffe Camera, Oxford, 40 m high
///   teapot            Newell's teapot in its own units, 6.434 long; scale it to taste
/// and one of model_families().
/// Buildings are sets of closed solids, outward-facing and overlapping where they meet: a ray from
/// outside meets front faces only. The same arguments give the same mesh, bit by bit.
///
/// Throws Error{bad_config} listing the names if there is no such model.
geometry::Mesh builtin_model(std::string_view name, const ModelOptions& options = {});

/// What the triangles of that model do to light; empty if all are matt.
std::vector<Surface> builtin_surfaces(std::string_view name, const ModelOptions& options = {});

}  // namespace skycap::sim
