/// A space-filling curve: neighbours on it are neighbours in space (Morton, "A computer oriented
/// geodetic data base", 1966).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

/// Cubic cells over all points.
struct CurveGrid {
  static constexpr int most_bits = 16;  ///< of each of a cell's three indices

  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< the lowest corner
  double step = 1.0;                                 ///< a cell's side

  /// The bits of a cell's indices in turn, x lowest; points outside have those of the border.
  std::uint64_t key(const Eigen::Vector3f& point) const;
};

/// Of 2^16 cells along the longest side of the points' box.
CurveGrid finest_grid(std::span<const Eigen::Vector3f> points);

/// A point by its key.
struct CurveEntry {
  std::uint64_t key = 0;
  std::uint32_t index = 0;
};

/// Gives entries of `points` their keys in a grid and sorts them, those of a cell as they were.
void sort_along_curve(std::vector<CurveEntry>& entries, std::span<const Eigen::Vector3f> points,
                      const CurveGrid& grid);

/// All points, sorted.
std::vector<CurveEntry> along_curve(std::span<const Eigen::Vector3f> points, const CurveGrid& grid);

}  // namespace skycap::geometry
