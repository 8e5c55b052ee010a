/// Line-of-sight tests between points: ray queries against a triangle mesh.
#pragma once

#include <memory>
#include <optional>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

/// Mesh prepared for ray queries. Triangles obstruct from both sides. Triangles without area are
/// skipped. Computation is in double precision without explicit vector instructions, so that
/// results do not depend on the processor. Immutable. Thread-safe for queries.
class SightLines {
 public:
  /// Builds the search tree on `threads` threads (zero: all processors), which do not affect the
  /// result. Keeps no reference to `mesh`. An empty mesh obstructs nothing.
  explicit SightLines(const Mesh& mesh, unsigned threads = 0);
  SightLines(SightLines&&) noexcept;
  SightLines& operator=(SightLines&&) noexcept;
  ~SightLines();

  /// Returns the distance from `origin` to the first triangle along the unit vector `direction`
  /// within `max_distance` [m], or nullopt if no triangle is hit.
  std::optional<double> first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double max_distance) const;

  /// Returns true if the line from `from` towards `to` is free over the first `fraction` of its
  /// length. With a fraction below 1, the surface at `to` does not obstruct it.
  bool is_clear(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double fraction) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::geometry
