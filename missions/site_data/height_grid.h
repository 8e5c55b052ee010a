/// Height grids: rasters of the ground or of objects on it, in the site frame.
///
/// The height of a node applies to its whole cell, which extends half a cell in each direction.
/// Between nodes, the surface is interpolated linearly. Cells without complete neighbours keep
/// their half cells.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/segment_distance.h"

namespace skycap::missions::site_data {

/// Grid of heights. All nodes are stored because the grid is slightly curved and rotated in the
/// site frame.
struct HeightGrid {
  std::size_t columns = 0, rows = 0;
  std::vector<Eigen::Vector3f> nodes;  ///< Cell centres, row by row; NaN for cells without height.
  /// Steps to the next node in the row and to the node in the next row. They are constant over the
  /// grid within a few thousandths.
  Eigen::Vector2f right = Eigen::Vector2f::Zero(), down = Eigen::Vector2f::Zero();
};

/// Returns the step for downsampling in each direction, such that at most two million nodes of a
/// large grid remain.
std::size_t compute_step(const HeightGrid& grid);

/// Keeps every `step`-th node in each direction and the last one. Each node gets the maximum height
/// of all nodes within `step` nodes, so that the surface is nowhere below that of `grid`.
HeightGrid downsampled(const HeightGrid& grid, std::size_t step);

/// Returns vertical boxes over all cells, each with the maximum height that touches it. Their lower
/// ends are arbitrary. In large grids, a box covers compute_step() cells in each direction.
std::vector<Eigen::AlignedBox3d> make_columns(const HeightGrid& grid);

/// Returns two triangles for each square of four nodes with heights.
std::vector<flight::Triangle> to_triangles(const HeightGrid& grid);

/// Returns horizontal triangles for the parts of cells that to_triangles() does not cover: at the
/// border of the grid and next to nodes without heights.
std::vector<flight::Triangle> make_rim_triangles(const HeightGrid& grid);

}  // namespace skycap::missions::site_data
