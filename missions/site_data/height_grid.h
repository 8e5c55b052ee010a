/// Heights on a grid: rasters of the ground or of what stands on it, in the site's frame.
///
/// A height is that of a whole cell, half a cell each way from its node; between nodes the surface
/// is taken to be straight. What lies beside a node without a height still has its half cell.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/space/segment_distance.h"

namespace skycap::missions::site_data {

/// In the site's frame it is a little curved and turned: hence all nodes.
struct HeightGrid {
  std::size_t columns = 0, rows = 0;
  std::vector<Eigen::Vector3f> nodes;  ///< middles of cells, row by row; NaN: the file has none
  /// From a node to the next in its row, and to that below it: the same all over the grid, but for
  /// a few thousandths.
  Eigen::Vector2f right = Eigen::Vector2f::Zero(), down = Eigen::Vector2f::Zero();
};

/// Of how many nodes one is kept, each way, so that of large grids at most two million are.
std::size_t step_of(const HeightGrid& grid);

/// Every `step`-th node each way, and the last, as high as the highest node less than a step or one
/// step away: its surface is nowhere below the grid's.
HeightGrid thinned(const HeightGrid& grid, std::size_t step);

/// Upright boxes over all cells, as high as the highest height that meets each. Their lower ends
/// mean nothing. Of large grids one box is over step_of() cells each way.
std::vector<Eigen::AlignedBox3d> columns_of(const HeightGrid& grid);

/// The triangles between nodes, two in each square of four that all have heights.
std::vector<flight::Triangle> triangles_of(const HeightGrid& grid);

/// The level rest of the cells that triangles_of() leaves out: at the border of the grid,
/// and beside nodes without heights.
std::vector<flight::Triangle> rim_of(const HeightGrid& grid);

}  // namespace skycap::missions::site_data
