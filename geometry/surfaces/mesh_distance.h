/// Distance of points from a surface, such as of a cloud from the ground truth or of a sensor from
/// walls.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

/// Mesh prepared for distance queries. Exact up to rounding. Immutable and thread-safe.
class MeshDistance {
 public:
  /// Builds the search structure on `threads` threads (zero: all processors). Keeps no reference to
  /// `mesh`. Triangles without area are skipped. Throws the errors of validate() in mesh.h.
  explicit MeshDistance(const Mesh& mesh, unsigned threads = 0);
  MeshDistance(MeshDistance&&) noexcept;
  MeshDistance& operator=(MeshDistance&&) noexcept;
  ~MeshDistance();

  struct Closest {
    Eigen::Vector3d point;  ///< point on the surface
    std::uint32_t
        triangle;  ///< triangle that contains `point`; the first one if `point` is on an edge
    double distance;
  };
  /// Returns the surface point nearest to `point`.
  Closest closest(const Eigen::Vector3d& point) const;

  /// Returns the unsigned distance of `point` from the surface [m].
  double distance(const Eigen::Vector3d& point) const { return closest(point).distance; }

  /// Returns whether every point of the segment is at least `distance` (greater than zero) from the
  /// surface. The test is conservative: it returns false if the clearance exceeds `distance` by
  /// less than a thousandth.
  bool keeps(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double distance) const;

  /// Writes the distance of each point to `distances`. Fast if many points are close to each other,
  /// in any order. Speed increases with batch sizes up to about one million points.
  void distances(std::span<const Eigen::Vector3f> points, std::span<double> distances,
                 unsigned threads = 1) const;
  void distances(std::span<const Eigen::Vector3d> points, std::span<double> distances,
                 unsigned threads = 1) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::geometry
