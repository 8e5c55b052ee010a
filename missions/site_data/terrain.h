/// The ground as files say it is: heights on a grid, or a surface of triangles.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/space/segment_distance.h"
#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

class Terrain {
 public:
  /// Of the grids and surfaces of these; a terrain has no points.
  explicit Terrain(const std::vector<const Prior*>& priors);
  ~Terrain();

  /// z of the highest ground there, or of a large grid up to a few cells away; nothing where no
  /// file has any.
  std::optional<double> height(const Eigen::Vector2d& place) const;

  /// All of it.
  geometry::Mesh surface() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// The triangles, each with vertices of its own.
geometry::Mesh mesh_of(const std::vector<flight::Triangle>& triangles);

}  // namespace skycap::missions::site_data
