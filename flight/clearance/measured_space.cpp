#include "flight/clearance/measured_space.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "flight/clearance/measured_voxels.h"
#include "geometry/pose/world.h"
#include "geometry/requirement.h"

namespace skycap::flight {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

void MeasuredSpaceConfig::validate() const {
  require(voxel > 0.0 && voxel <= 1e3, "measured_space.voxel", voxel, "positive, at most 1000 m");
  require(depth_margin >= 0.0 && std::isfinite(depth_margin), "measured_space.depth_margin",
          depth_margin, "zero or more");
  require(free_without_return >= 0.0 && std::isfinite(free_without_return),
          "measured_space.free_without_return", free_without_return, "zero or more");
  require(max_depth > 0.0 && max_depth < 1e5 * voxel, "measured_space.max_depth", max_depth,
          "positive and below 100,000 voxels");
  require(!floor || std::isfinite(*floor), "measured_space.floor", floor.value_or(0.0),
          "a finite number");
  const auto is_near = [&](const Vector3d& corner) {  // False for NaN, too.
    return (corner.array().abs() < 1e5 * voxel).all() && geometry::is_valid_position(corner);
  };
  const auto require_near = [&](const AlignedBox3d& box, const char* name) {
    if (box.isEmpty()) return;
    const double farthest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
    require(is_near(box.min()) && is_near(box.max()), name, farthest,
            "within 100,000 voxels and 10,000 km of the origin");
  };
  require_near(region, "measured_space.region");
  for (const AlignedBox3d& box : extra_boxes) require_near(box, "measured_space.beside");
}

MeasuredSpace::MeasuredSpace(const MeasuredSpaceConfig& config) {
  config.validate();
  impl_ = std::make_unique<Impl>();
  impl_->config = config;
  const auto add = [&](const AlignedBox3d& region) {
    const VoxelRegion voxels = voxel_region(region, config.voxel);
    impl_->regions.push_back(voxels);
    impl_->boxes.emplace_back(voxels.low.cast<double>() * config.voxel,
                              voxels.high.cast<double>() * config.voxel);
  };
  add(config.region);
  if (!impl_->is_bounded()) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    impl_->boxes[0] = {Vector3d::Constant(-infinity), Vector3d::Constant(infinity)};
    return;
  }
  for (const AlignedBox3d& box : config.extra_boxes) {
    if (!box.isEmpty()) add(box);
  }
}

MeasuredSpace::~MeasuredSpace() = default;
MeasuredSpace::MeasuredSpace(MeasuredSpace&&) noexcept = default;
MeasuredSpace& MeasuredSpace::operator=(MeasuredSpace&&) noexcept = default;

void MeasuredSpace::declare_free(const Vector3d& centre, double radius) {
  const AlignedBox3d around(centre - Vector3d::Constant(radius),
                            centre + Vector3d::Constant(radius));
  impl_->free_where(around, 1, [&](const AlignedBox3d& box) {
    const Vector3d farthest_corner = (centre - box.min()).cwiseMax(box.max() - centre);
    if (farthest_corner.norm() <= radius) return BallVisibility::free;
    return box.exteriorDistance(centre) > radius ? BallVisibility::hidden : BallVisibility::partial;
  });
}

void MeasuredSpace::declare_free(const AlignedBox3d& region) {
  impl_->free_where(region, 1, [&](const AlignedBox3d& box) {
    if (region.contains(box)) return BallVisibility::free;
    return region.intersects(box) ? BallVisibility::partial : BallVisibility::hidden;
  });
}

void MeasuredSpace::insert(const geometry::Scan& scan, const geometry::Camera& camera,
                           unsigned threads) {
  const MeasuredSpaceConfig& config = impl_->config;
  impl_->carve(RangeImage(scan, camera, config.free_without_return, config.max_depth, threads),
               threads);
  impl_->occupy(scan, threads);
}

void MeasuredSpace::insert(const geometry::Scan& scan, const SweepRays& rays, unsigned threads) {
  impl_->carve(RangeImage(scan, rays, impl_->config.max_depth, threads), threads);
  impl_->occupy(scan, threads);
}

void MeasuredSpace::insert_points(const geometry::Scan& scan, unsigned threads) {
  impl_->occupy(scan, threads);
}

void MeasuredSpace::merge_free(const MeasuredSpace& other) {
  const double voxel = impl_->config.voxel;
  require(other.impl_->config.voxel == voxel, "measured_space.voxel", other.impl_->config.voxel,
          "equal to the voxel size of the space to which it is added");
  const VoxelBlocks& blocks = other.impl_->blocks;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Cell cell = unpack_cell(blocks.keys()[i]);
    const AlignedBox3d box = impl_->block_box(cell);
    if (!impl_->meets_region(box)) continue;
    const VoxelBlock* known = impl_->blocks.find(blocks.keys()[i]).block;
    VoxelBlock block = known == nullptr ? VoxelBlock{} : *known;
    const Slices before = block.free;
    for (int z = 0; z < 8; ++z) block.free[z] |= blocks.blocks()[i].passable(z);
    if (block.free == before) continue;
    impl_->set(cell, block);
  }
}

Closest MeasuredSpace::closest(const Segment& leg, double up_to) const {
  // The leg is divided into pieces of a few blocks, whose boxes are slim. The search distance grows
  // until it contains an obstacle, so that distant blocks need not be examined.
  const auto segments =
      static_cast<std::size_t>(std::ceil(leg.length() / (4.0 * impl_->block_size()))) + 1;
  for (double reach = std::min(up_to, impl_->block_size());; reach = std::min(up_to, 2.0 * reach)) {
    Closest best{reach};
    for (std::size_t i = 0; i < segments && best.distance > 0.0; ++i) {
      const auto count = static_cast<double>(segments);
      const double begin = static_cast<double>(i) / count, end = static_cast<double>(i + 1) / count;
      impl_->closest_in({leg.at(begin), leg.at(end)}, best);
    }
    if (best.kind != ObstacleKind::none || reach >= up_to) return best;
  }
}

bool MeasuredSpace::continues_free(const Segment& leg, double clearance) const {
  return closest(leg, clearance + clearance_guard).kind == ObstacleKind::none;
}

AlignedBox3d MeasuredSpace::extent() const {
  return impl_->is_bounded() ? impl_->mapped_box() : impl_->extent;
}

AlignedBox3d MeasuredSpace::known_box() const {
  return impl_->is_bounded() ? impl_->listed.merged(impl_->boxes[0]) : impl_->listed;
}

std::string MeasuredSpace::name(const Closest& closest) const {
  if (closest.kind == ObstacleKind::unknown_space) return "unobserved space";
  if (closest.kind == ObstacleKind::occupied_space) return "a measured point";
  return "";
}

const MeasuredSpaceConfig& MeasuredSpace::config() const { return impl_->config; }

double MeasuredSpace::free_volume() const {
  std::size_t voxels = 0;
  const VoxelBlocks& blocks = impl_->blocks;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!impl_->boxes[0].intersects(impl_->block_box(unpack_cell(blocks.keys()[i])))) continue;
    for (int z = 0; z < 8; ++z) {
      voxels += static_cast<std::size_t>(std::popcount(blocks.blocks()[i].passable(z)));
    }
  }
  return static_cast<double>(voxels) * std::pow(impl_->config.voxel, 3);
}

}  // namespace skycap::flight
