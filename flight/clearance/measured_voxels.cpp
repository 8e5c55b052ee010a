#include "flight/clearance/measured_voxels.h"

#include <cmath>
#include <span>
#include <vector>

namespace skycap::flight {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

namespace {

/// Voxels of a block that contain points.
struct OccupiedVoxels {
  Cell block;
  Slices voxels{};
};

/// Returns the voxels in the order of the points. Neighbouring pixels usually belong to the same
/// block.
std::vector<OccupiedVoxels> collect_voxels(std::span<const Eigen::Vector3f> points,
                                           const MeasuredSpaceConfig& config) {
  std::vector<OccupiedVoxels> occupied;
  for (const Eigen::Vector3f& p : points) {
    const Vector3d point = p.cast<double>();
    if (config.floor && point.z() < *config.floor) continue;
    const Cell voxel = (point / config.voxel).array().floor().matrix().cast<int>();
    const Cell block = voxel.unaryExpr([](int at) { return at >> 3; });
    if (occupied.empty() || occupied.back().block != block) occupied.push_back({block});
    const Cell local_voxel = voxel - 8 * block;
    occupied.back().voxels[local_voxel.z()] |= std::uint64_t{1}
                                               << (8 * local_voxel.y() + local_voxel.x());
  }
  return occupied;
}

}  // namespace

VoxelRegion voxel_region(const AlignedBox3d& region, double voxel) {
  // Beyond all voxels, but small enough for exact integer sums and differences.
  constexpr int far = 1 << 28;
  if (region.isEmpty()) return {Cell::Constant(-far), Cell::Constant(far)};
  return {(region.min() / voxel).array().floor().matrix().cast<int>(),
          (region.max() / voxel).array().ceil().matrix().cast<int>()};
}

Slices blocked_voxels(std::span<const VoxelRegion> regions, const Cell& cell,
                      const VoxelBlock& block) {
  Slices inside{};
  for (const VoxelRegion& region : regions) {
    const Cell low = (region.low - 8 * cell).cwiseMax(0);
    const Cell high = (region.high - 8 * cell).cwiseMin(8);
    if (low.maxCoeff() == 0 && high.minCoeff() == 8) {
      inside.fill(~std::uint64_t{0});
      break;
    }
    for (int z = low.z(); z < high.z(); ++z) {
      for (int y = low.y(); y < high.y(); ++y) {
        for (int x = low.x(); x < high.x(); ++x) inside[z] |= std::uint64_t{1} << (8 * y + x);
      }
    }
  }
  Slices blocked{};
  for (int z = 0; z < 8; ++z) blocked[z] = ~block.passable(z) & (inside[z] | block.occupied[z]);
  return blocked;
}

void MeasuredSpace::Impl::occupy(const geometry::Scan& scan, unsigned threads) {
  constexpr std::size_t part_size = 1 << 16;
  const std::span<const Eigen::Vector3f> points = scan.points;
  const std::size_t parts = (points.size() + part_size - 1) / part_size;
  std::vector<std::vector<OccupiedVoxels>> occupied(parts);
  geometry::parallel_for(parts, threads, [&](std::size_t part) {
    const std::size_t first = part * part_size;
    occupied[part] =
        collect_voxels(points.subspan(first, std::min(part_size, points.size() - first)), config);
  });
  for (const std::vector<OccupiedVoxels>& part : occupied) {
    for (const auto& [cell, voxels] : part) {
      VoxelBlock block = known_block(cell);
      for (std::size_t z = 0; z < voxels.size(); ++z) block.occupied[z] |= voxels[z];
      set(cell, block);
    }
  }
}

void MeasuredSpace::Impl::carve(const RangeImage& image, unsigned threads) {
  free_where(image.reach(), threads, [&](const AlignedBox3d& box) {
    return image.visibility(box.center(), 0.5 * box.diagonal().norm(), config.depth_margin);
  });
}

void MeasuredSpace::Impl::closest_in_cube(const Segment& segment, const BoxTest& test,
                                          const Cell& cell, const Cube& cube,
                                          const VoxelBlock& block, const Slices& blocked,
                                          Closest& best) const {
  const std::uint64_t mask = cube.mask();
  std::uint64_t any = 0, all = mask;
  for (int z = cube.low.z(); z < cube.low.z() + cube.edge; ++z) {
    any |= blocked[z] & mask;
    all &= blocked[z];
  }
  if (any == 0) return;
  const AlignedBox3d box = cube_box(cell, cube);
  if (cube.edge < 8 && !test.is_near(box, best.distance)) return;
  if (all == mask) {
    const NearestPoints pair = nearest(segment, box);
    if (!(pair.squared_distance < best.distance * best.distance)) return;
    const Cell voxel =
        (pair.on_other / config.voxel).array().floor().matrix().cast<int>() - 8 * cell;
    const Cell last = cube.low + Cell::Constant(cube.edge - 1);
    best = {std::sqrt(pair.squared_distance),
            block.is_occupied(voxel.cwiseMax(cube.low).cwiseMin(last))
                ? ObstacleKind::occupied_space
                : ObstacleKind::unknown_space,
            0, pair.on_segment, pair.on_other};
    return;
  }
  const int half = cube.edge / 2;
  for (int corner = 0; corner < 8 && best.distance > 0.0; ++corner) {
    const Cell offset(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    closest_in_cube(segment, test, cell, {cube.low + half * offset, half}, block, blocked, best);
  }
}

/// Updates `best` with obstacles closer to a short piece.
void MeasuredSpace::Impl::closest_in(const Segment& segment, Closest& best) const {
  const Vector3d reach = Vector3d::Constant(best.distance);
  const AlignedBox3d around = mapped_box().intersection(
      {segment.from.cwiseMin(segment.to) - reach, segment.from.cwiseMax(segment.to) + reach});
  if (around.isEmpty()) return;  // For example a return above all obstacles.
  const BoxTest test(segment);
  for_each_block(around, [&](const Cell& cell) {
    const VoxelBlocks::Found found = blocks.find(cell_key(cell));
    // Most blocks are passable. Computing their distance would take longer.
    if (found.is_all_passable) return true;
    const AlignedBox3d box = block_box(cell);
    if (!test.is_near(box, best.distance)) return true;
    if (found.block != nullptr) {
      closest_in_cube(segment, test, cell, {Cell::Zero(), 8}, *found.block,
                      blocked_voxels(regions, cell, *found.block), best);
      return best.distance > 0.0;
    }
    for (std::size_t i = 0; i < regions.size(); ++i) {
      const bool is_inside = (8 * cell.array() < regions[i].high.array()).all() &&
                             (8 * cell.array() + 8 > regions[i].low.array()).all();
      if (!is_inside) continue;
      const NearestPoints pair = nearest(segment, box.intersection(boxes[i]));
      if (pair.squared_distance < best.distance * best.distance) {
        best = {std::sqrt(pair.squared_distance), ObstacleKind::unknown_space, 0, pair.on_segment,
                pair.on_other};
      }
    }
    return best.distance > 0.0;
  });
}

}  // namespace skycap::flight
