/// Voxels of a MeasuredSpace. Internal to measured_space.h.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "flight/clearance/bounding_tree.h"
#include "flight/clearance/cell_map.h"
#include "flight/clearance/measured_space.h"
#include "flight/clearance/range_image.h"
#include "flight/clearance/segment_distance.h"
#include "flight/clearance/voxel_block.h"
#include "flight/clearance/voxel_blocks.h"
#include "geometry/parallel.h"

namespace skycap::flight {

/// Half-open range of voxels.
struct VoxelRegion {
  Cell low, high;
};

/// Returns the voxels of a region. For an empty region, returns all of space.
VoxelRegion voxel_region(const Eigen::AlignedBox3d& region, double voxel);

/// Returns the voxels of a block that block a path. Inside the regions these are all except free
/// voxels, outside the occupied ones.
Slices blocked_voxels(std::span<const VoxelRegion> regions, const Cell& cell,
                      const VoxelBlock& block);

struct MeasuredSpace::Impl {
  MeasuredSpaceConfig config;
  VoxelBlocks blocks;  ///< A missing block is unknown.
  /// Voxel ranges of the configured region (or of all space) and of the further regions.
  std::vector<VoxelRegion> regions;
  std::vector<Eigen::AlignedBox3d> boxes;  ///< Boxes of `regions`.
  /// Bounds of all listed blocks, and of those that contain obstacles: blocks in the regions or
  /// with points.
  Eigen::AlignedBox3d listed, extent;

  bool is_bounded() const { return !config.region.isEmpty(); }
  bool meets_region(const Eigen::AlignedBox3d& box) const {
    return std::ranges::any_of(
        boxes, [&](const Eigen::AlignedBox3d& region) { return region.intersects(box); });
  }
  /// Returns a box outside of which everything is free.
  Eigen::AlignedBox3d mapped_box() const {
    Eigen::AlignedBox3d hull = extent;
    for (const Eigen::AlignedBox3d& region : boxes) hull.extend(region);
    return hull;
  }
  double block_size() const { return 8.0 * config.voxel; }
  Cell block_at(const Eigen::Vector3d& point) const {
    return (point / block_size()).array().floor().matrix().cast<int>();
  }
  Eigen::AlignedBox3d block_box(const Cell& cell) const {
    const Eigen::Vector3d low = cell.cast<double>() * block_size();
    return {low, low + Eigen::Vector3d::Constant(block_size())};
  }
  Eigen::AlignedBox3d cube_box(const Cell& block, const Cube& cube) const {
    const Eigen::Vector3d low = (8 * block + cube.low).cast<double>() * config.voxel;
    return {low, low + Eigen::Vector3d::Constant(cube.edge * config.voxel)};
  }

  /// Returns the block of a cell, or an unknown block if the cell is not listed.
  VoxelBlock known_block(const Cell& cell) const {
    const VoxelBlock* known = blocks.find(cell_key(cell)).block;
    return known == nullptr ? VoxelBlock{} : *known;
  }
  void set(const Cell& cell, const VoxelBlock& block) {
    blocks.set(cell_key(cell), block);
    const Eigen::AlignedBox3d box = block_box(cell);
    listed.extend(box);
    if (block.is_any_occupied() || meets_region(box)) extent.extend(box);
  }

  template <typename Visit>
  void for_each_block(const Eigen::AlignedBox3d& box, Visit visit) const;
  template <typename Decide>
  void free_where(const Eigen::AlignedBox3d& box, unsigned threads, Decide decide);
  template <typename Decide>
  void free_within(const Cell& cell, const Cube& cube, VoxelBlock& block, Decide decide) const;
  void occupy(const geometry::Scan& scan, unsigned threads);
  void carve(const RangeImage& image, unsigned threads);
  void closest_in(const Segment& segment, Closest& best) const;
  void closest_in_cube(const Segment& segment, const BoxTest& test, const Cell& cell,
                       const Cube& cube, const VoxelBlock& block, const Slices& blocked,
                       Closest& best) const;
};

/// Visits all block cells that intersect the box. `visit` returns false to stop.
template <typename Visit>
void MeasuredSpace::Impl::for_each_block(const Eigen::AlignedBox3d& box, Visit visit) const {
  const Cell low = block_at(box.min()), high = block_at(box.max());
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        if (!visit(Cell(x, y, z))) return;
      }
    }
  }
}

/// Marks cubes for which `decide(box)` returns BallVisibility::free, in blocks that intersect both
/// the box and a region. `decide` must be thread-safe.
template <typename Decide>
void MeasuredSpace::Impl::free_where(const Eigen::AlignedBox3d& box, unsigned threads,
                                     Decide decide) {
  std::vector<Cell> cells;
  Eigen::AlignedBox3d hull;
  for (const Eigen::AlignedBox3d& region : boxes) hull.extend(region);
  for_each_block(box.intersection(hull), [&](const Cell& cell) {
    if (boxes.size() == 1 || meets_region(block_box(cell))) cells.push_back(cell);
    return true;
  });
  constexpr std::size_t part_size = 64;
  const std::size_t parts = (cells.size() + part_size - 1) / part_size;
  struct Changed {
    Cell cell;
    VoxelBlock block;
  };
  std::vector<std::vector<Changed>> changed(parts);
  geometry::parallel_for(parts, threads, [&](std::size_t part) {
    const std::size_t end = std::min(cells.size(), (part + 1) * part_size);
    for (std::size_t i = part * part_size; i < end; ++i) {
      VoxelBlock block = known_block(cells[i]);
      const Slices before = block.free;
      free_within(cells[i], {Cell::Zero(), 8}, block, decide);
      if (block.free != before) changed[part].push_back({cells[i], block});
    }
  });
  for (const std::vector<Changed>& part : changed) {
    for (const auto& [cell, block] : part) set(cell, block);
  }
}

/// Divides a partially visible cube into eight, down to single voxels.
template <typename Decide>
void MeasuredSpace::Impl::free_within(const Cell& cell, const Cube& cube, VoxelBlock& block,
                                      Decide decide) const {
  if (block.is_all_free(cube)) return;
  const BallVisibility visibility = decide(cube_box(cell, cube));
  if (visibility == BallVisibility::free) block.set_free(cube);
  if (visibility != BallVisibility::partial || cube.edge == 1) return;
  const int half = cube.edge / 2;
  for (int corner = 0; corner < 8; ++corner) {
    const Cell offset(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    free_within(cell, {cube.low + half * offset, half}, block, decide);
  }
}

}  // namespace skycap::flight
