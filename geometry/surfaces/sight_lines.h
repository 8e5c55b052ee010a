/// Whether straight lines between points are obstructed by a surface: rays against a triangle mesh.
#pragma once

#include <memory>
#include <optional>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

/// A mesh prepared for ray queries. Both sides of a triangle obstruct; triangles without area are
/// skipped. In double precision and without vector instructions of its own, so that results do not
/// depend on the processor. Immutable; safe to query from several threads.
class SightLines {
 public:
  /// Built on `threads` threads (zero: all processors), which do not change the result. Keeps no
  /// reference. An empty mesh obstructs nothing.
  explicit SightLines(const Mesh& mesh, unsigned threads = 0);
  SightLines(SightLines&&) noexcept;
  SightLines& operator=(SightLines&&) noexcept;
  ~SightLines();

  /// Distance from `origin` [m] to the first triangle along `direction` (unit) that is nearer than
  /// `max_distance`; nothing without one.
  std::optional<double> first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double max_distance) const;

  /// Whether the line from `from` towards `to` is free for the fraction `fraction` of its length.
  /// Below 1, the surface that `to` lies on does not obstruct it.
  bool is_clear(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double fraction) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::geometry
