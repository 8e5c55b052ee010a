/// Ground from terrain files: height grids or triangle surfaces.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/segment_distance.h"
#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

class Terrain {
 public:
  /// Uses the grids and surfaces of `priors`, which must not contain points.
  explicit Terrain(const std::vector<const Prior*>& priors);
  ~Terrain();

  /// Returns the maximum ground height at a position, in large grids within a few cells of it.
  /// Returns an empty value where the terrain is unknown [m].
  std::optional<double> height(const Eigen::Vector2d& position) const;

  /// Returns the whole terrain as a mesh.
  geometry::Mesh surface() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// Returns a mesh of the triangles without shared vertices.
geometry::Mesh make_mesh(const std::vector<flight::Triangle>& triangles);

}  // namespace skycap::missions::site_data
