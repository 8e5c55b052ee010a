/// Space-filling curve: neighbours on the curve are neighbours in space (Morton, "A computer
/// oriented geodetic data base", 1966).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

/// Grid of cubic cells that covers all points.
struct CurveGrid {
  static constexpr int max_bits = 16;  ///< bits per cell index

  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< minimum corner of the grid [m]
  double step = 1.0;                                 ///< cell size [m]

  /// Returns the interleaved bits of the cell indices, with x in the lowest bit. Points outside the
  /// grid are clamped to the border cells.
  std::uint64_t key(const Eigen::Vector3f& point) const;
};

/// Returns a grid with 2^16 cells along the longest side of the bounding box of `points`.
CurveGrid finest_grid(std::span<const Eigen::Vector3f> points);

/// Curve key and index of a point.
struct CurveEntry {
  std::uint64_t key = 0;
  std::uint32_t index = 0;
};

/// Sets the keys of `entries`, which index `points`, and sorts them by key. The sort is stable
/// within a cell.
void sort_along_curve(std::vector<CurveEntry>& entries, std::span<const Eigen::Vector3f> points,
                      const CurveGrid& grid);

/// Returns one entry per point, sorted along the curve.
std::vector<CurveEntry> along_curve(std::span<const Eigen::Vector3f> points, const CurveGrid& grid);

}  // namespace skycap::geometry
