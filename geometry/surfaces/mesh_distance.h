/// How far points are from a surface: of a cloud from the truth, of a sensor from walls.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

/// A mesh made ready for distance queries. Exact up to rounding. Immutable; safe to query from any
/// number of threads.
class MeshDistance {
 public:
  /// Built on `threads` threads (zero: all processors). Keeps no reference to `mesh`; triangles
  /// without area are passed over. Throws what validate() of mesh.h throws.
  explicit MeshDistance(const Mesh& mesh, unsigned threads = 0);
  MeshDistance(MeshDistance&&) noexcept;
  MeshDistance& operator=(MeshDistance&&) noexcept;
  ~MeshDistance();

  struct Closest {
    Eigen::Vector3d point;   ///< on the surface
    std::uint32_t triangle;  ///< that it lies on; the first of them, if it is on an edge
    double distance;
  };
  /// The surface point nearest to `point`.
  Closest closest(const Eigen::Vector3d& point) const;

  /// Distance of `point` from the surface, never negative.
  double distance(const Eigen::Vector3d& point) const { return closest(point).distance; }

  /// Whether every place between two is at least that far, more than nothing, from the surface. A
  /// way that grazes the distance, to a thousandth of it, is not said to keep it.
  bool keeps(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double distance) const;

  /// The distance of each point, to a place of `distances`. Quick where there are many points near
  /// each other, in any order: up to a million at once are worth while.
  void distances(std::span<const Eigen::Vector3f> points, std::span<double> distances,
                 unsigned threads = 1) const;
  void distances(std::span<const Eigen::Vector3d> points, std::span<double> distances,
                 unsigned threads = 1) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::geometry
