/// How far points and segments are from a surface: of a cloud from the truth, of a route from
/// walls.
#pragma once

#include <cstdint>
#include <memory>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

/// A mesh made ready for distance queries. Exact up to rounding. Immutable; safe to query from any
/// number of threads.
class MeshDistance {
 public:
  /// Keeps no reference to `mesh`; triangles without area are passed over. Throws what validate()
  /// of mesh.h throws.
  explicit MeshDistance(const Mesh& mesh);
  MeshDistance(MeshDistance&&) noexcept;
  MeshDistance& operator=(MeshDistance&&) noexcept;
  ~MeshDistance();

  struct Closest {
    Eigen::Vector3d point;   ///< on the surface
    std::uint32_t triangle;  ///< that it lies on; one of them, if it is on an edge
    double distance;
  };
  /// The surface point nearest to `point`.
  Closest closest(const Eigen::Vector3d& point) const;

  /// Distance of `point` from the surface, never negative.
  double distance(const Eigen::Vector3d& point) const { return closest(point).distance; }

  /// Smallest distance between the segment's points and the surface; zero if it cuts the surface.
  double distance(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::geometry
