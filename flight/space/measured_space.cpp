#include "flight/space/measured_space.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <istream>
#include <limits>
#include <ostream>
#include <string>
#include <unordered_map>
#include <vector>

#include "flight/space/bounding_tree.h"
#include "flight/space/cell_map.h"
#include "flight/space/range_image.h"
#include "flight/space/voxel_block.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

struct HashKey {
  std::size_t operator()(std::uint64_t key) const {
    const std::uint64_t product = key * 0x9e3779b97f4a7c15ULL;
    return product ^ product >> 32;
  }
};

}  // namespace

struct MeasuredSpace::Impl {
  MeasuredSpaceConfig config;
  std::unordered_map<std::uint64_t, VoxelBlock, HashKey> blocks;  ///< a block not listed is unknown
  AlignedBox3d region;           ///< the configuration's, of whole voxels; without one all of space
  Cell region_low, region_high;  ///< its voxels, the end excluded
  AlignedBox3d extent;           ///< of all listed blocks

  bool is_bounded() const { return !config.region.isEmpty(); }
  double block_size() const { return 8.0 * config.voxel; }
  Cell block_of(const Vector3d& point) const {
    return (point / block_size()).array().floor().matrix().cast<int>();
  }
  AlignedBox3d block_box(const Cell& cell) const {
    const Vector3d low = cell.cast<double>() * block_size();
    return {low, low + Vector3d::Constant(block_size())};
  }
  AlignedBox3d cube_box(const Cell& block, const Cube& cube) const {
    const Vector3d low = (8 * block + cube.low).cast<double>() * config.voxel;
    return {low, low + Vector3d::Constant(cube.edge * config.voxel)};
  }

  template <typename Visit>
  void for_each_block(const AlignedBox3d& box, Visit visit) const;
  template <typename Decide>
  void free_where(const AlignedBox3d& box, Decide decide);
  template <typename Decide>
  void free_within(const Cell& cell, const Cube& cube, VoxelBlock& block, Decide decide) const;
  void occupy(const geometry::Scan& scan);
  void carve(const RangeImage& image);
  void closest_in(const Segment& piece, Closest& best) const;
  /// The voxels of a block that are not free, or outside of the region occupied.
  Slices blocked(const Cell& cell, const VoxelBlock& block) const;
  void closest_in_cube(const Segment& piece, const BoxTest& test, const Cell& cell,
                       const Cube& cube, const VoxelBlock& block, const Slices& blocked,
                       Closest& best) const;
};

/// Visits block cells that meet the box; `visit` returns false to stop.
template <typename Visit>
void MeasuredSpace::Impl::for_each_block(const AlignedBox3d& box, Visit visit) const {
  const Cell low = block_of(box.min()), high = block_of(box.max());
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        if (!visit(Cell(x, y, z))) return;
      }
    }
  }
}

/// Frees, in blocks that meet the box, the cubes of which `decide(box)` says so.
template <typename Decide>
void MeasuredSpace::Impl::free_where(const AlignedBox3d& box, Decide decide) {
  const Cube whole{Cell::Zero(), 8};
  for_each_block(box.intersection(region), [&](const Cell& cell) {
    const auto known = blocks.find(cell_key(cell));
    VoxelBlock block = known == blocks.end() ? VoxelBlock{} : known->second;
    free_within(cell, whole, block, decide);
    if (known != blocks.end()) {
      known->second = block;
    } else if (block.free != VoxelBlock{}.free) {
      blocks.emplace(cell_key(cell), block);
      extent.extend(cube_box(cell, whole));
    }
    return true;
  });
}

/// A cube that is neither free nor hidden as a whole is cut into eight, down to voxels.
template <typename Decide>
void MeasuredSpace::Impl::free_within(const Cell& cell, const Cube& cube, VoxelBlock& block,
                                      Decide decide) const {
  if (block.is_all_free(cube)) return;
  const BallSight sight = decide(cube_box(cell, cube));
  if (sight == BallSight::free) block.set_free(cube);
  if (sight != BallSight::partial || cube.edge == 1) return;
  const int half = cube.edge / 2;
  for (int corner = 0; corner < 8; ++corner) {
    const Cell offset(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    free_within(cell, {cube.low + half * offset, half}, block, decide);
  }
}

void MeasuredSpace::Impl::occupy(const geometry::Scan& scan) {
  // Neighbouring pixels mostly hit the same block.
  Cell last_cell = Cell::Zero();
  VoxelBlock* last = nullptr;
  for (const Eigen::Vector3f& p : scan.points) {
    const Vector3d point = p.cast<double>();
    if (point.z() < config.floor) continue;
    const Cell cell = block_of(point);
    const Cell voxel = ((point / config.voxel).array().floor().matrix().cast<int>() - 8 * cell)
                           .cwiseMax(0)
                           .cwiseMin(7);
    if (last == nullptr || cell != last_cell) {
      const auto [block, is_new] = blocks.try_emplace(cell_key(cell));
      if (is_new) extent.extend(block_box(cell));
      last = &block->second;
      last_cell = cell;
    }
    last->occupied[voxel.z()] |= std::uint64_t{1} << (8 * voxel.y() + voxel.x());
  }
}

void MeasuredSpace::Impl::carve(const RangeImage& image) {
  free_where(image.reach(), [&](const AlignedBox3d& box) {
    return image.sight(box.center(), 0.5 * box.diagonal().norm(), config.depth_margin);
  });
}

Slices MeasuredSpace::Impl::blocked(const Cell& cell, const VoxelBlock& block) const {
  Slices blocked{};
  const bool is_cut = !region.contains(block_box(cell));
  const Cell low = (region_low - 8 * cell).cwiseMax(0), high = (region_high - 8 * cell).cwiseMin(8);
  for (int z = 0; z < 8; ++z) {
    blocked[z] = ~block.passable(z);
    if (!is_cut) continue;
    std::uint64_t inside = 0;
    for (int y = low.y(); y < high.y() && z >= low.z() && z < high.z(); ++y) {
      for (int x = low.x(); x < high.x(); ++x) inside |= std::uint64_t{1} << (8 * y + x);
    }
    blocked[z] &= inside | block.occupied[z];
  }
  return blocked;
}

void MeasuredSpace::Impl::closest_in_cube(const Segment& piece, const BoxTest& test,
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
    const NearestPoints pair = nearest(piece, box);
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
    closest_in_cube(piece, test, cell, {cube.low + half * offset, half}, block, blocked, best);
  }
}

/// Lowers `best` to what is nearer to a short piece than that.
void MeasuredSpace::Impl::closest_in(const Segment& piece, Closest& best) const {
  const Vector3d reach = Vector3d::Constant(best.distance);
  const AlignedBox3d around(piece.from.cwiseMin(piece.to) - reach,
                            piece.from.cwiseMax(piece.to) + reach);
  const BoxTest test(piece);
  for_each_block(around, [&](const Cell& cell) {
    const AlignedBox3d box = block_box(cell);
    if (!test.is_near(box, best.distance)) return true;
    const auto found = blocks.find(cell_key(cell));
    if (found != blocks.end()) {
      const VoxelBlock& block = found->second;
      if (!block.is_all_passable()) {
        closest_in_cube(piece, test, cell, {Cell::Zero(), 8}, block, blocked(cell, block), best);
      }
      return best.distance > 0.0;
    }
    const bool is_inside = (8 * cell.array() < region_high.array()).all() &&
                           (8 * cell.array() + 8 > region_low.array()).all();
    if (!is_inside) return true;
    const NearestPoints pair = nearest(piece, box.intersection(region));
    if (pair.squared_distance < best.distance * best.distance) {
      best = {std::sqrt(pair.squared_distance), ObstacleKind::unknown_space, 0, pair.on_segment,
              pair.on_other};
    }
    return best.distance > 0.0;
  });
}

void MeasuredSpaceConfig::validate() const {
  const auto require = [](bool holds, const char* field, double value, const char* right) {
    if (holds) return;
    throw Error(ErrorKind::bad_config, "measured_space." + std::string(field) + " is " +
                                           std::to_string(value) + " m; it must be " + right);
  };
  require(voxel > 0.0 && std::isfinite(voxel), "voxel", voxel, "positive");
  require(depth_margin >= 0.0, "depth_margin", depth_margin, "zero or more");
  require(free_without_return >= 0.0, "free_without_return", free_without_return, "zero or more");
  require(max_depth > 0.0 && max_depth < 1e5 * voxel, "max_depth", max_depth,
          "positive and below 100,000 voxels");
  require(std::isfinite(floor), "floor", floor, "a finite number");
  if (region.isEmpty()) return;
  const double farthest = region.min().cwiseAbs().cwiseMax(region.max().cwiseAbs()).maxCoeff();
  require(farthest < 1e5 * voxel, "region", farthest, "within 100,000 voxels of the origin");
}

MeasuredSpace::MeasuredSpace(const MeasuredSpaceConfig& config) {
  config.validate();
  impl_ = std::make_unique<Impl>();
  impl_->config = config;
  if (impl_->is_bounded()) {
    impl_->region_low = (config.region.min() / config.voxel).array().floor().matrix().cast<int>();
    impl_->region_high = (config.region.max() / config.voxel).array().ceil().matrix().cast<int>();
    impl_->region = {impl_->region_low.cast<double>() * config.voxel,
                     impl_->region_high.cast<double>() * config.voxel};
  } else {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    impl_->region = {Vector3d::Constant(-infinity), Vector3d::Constant(infinity)};
    // Far beyond all voxels, yet so that sums and differences of them are whole numbers still.
    impl_->region_low = Cell::Constant(-(1 << 28));
    impl_->region_high = Cell::Constant(1 << 28);
  }
}

MeasuredSpace::~MeasuredSpace() = default;
MeasuredSpace::MeasuredSpace(MeasuredSpace&&) noexcept = default;
MeasuredSpace& MeasuredSpace::operator=(MeasuredSpace&&) noexcept = default;

void MeasuredSpace::declare_free(const Vector3d& centre, double radius) {
  const AlignedBox3d around(centre - Vector3d::Constant(radius),
                            centre + Vector3d::Constant(radius));
  impl_->free_where(around, [&](const AlignedBox3d& box) {
    const Vector3d farthest_corner = (centre - box.min()).cwiseMax(box.max() - centre);
    if (farthest_corner.norm() <= radius) return BallSight::free;
    return box.exteriorDistance(centre) > radius ? BallSight::hidden : BallSight::partial;
  });
}

void MeasuredSpace::declare_free(const AlignedBox3d& region) {
  impl_->free_where(region, [&](const AlignedBox3d& box) {
    if (region.contains(box)) return BallSight::free;
    return region.intersects(box) ? BallSight::partial : BallSight::hidden;
  });
}

void MeasuredSpace::insert(const geometry::Scan& scan, const geometry::Camera& camera) {
  impl_->carve(
      RangeImage(scan, camera, impl_->config.free_without_return, impl_->config.max_depth));
  impl_->occupy(scan);
}

void MeasuredSpace::insert(const geometry::Scan& scan, double ray_spacing) {
  impl_->carve(RangeImage(scan, ray_spacing, impl_->config.max_depth));
  impl_->occupy(scan);
}

Closest MeasuredSpace::closest(const Segment& leg, double up_to) const {
  // Pieces of a few blocks, so that the box around each is slim; a reach that grows until something
  // is within it, so that near things are found without looking at far ones.
  const auto pieces =
      static_cast<std::size_t>(std::ceil(leg.length() / (4.0 * impl_->block_size()))) + 1;
  for (double reach = std::min(up_to, impl_->block_size());; reach = std::min(up_to, 2.0 * reach)) {
    Closest best{reach};
    for (std::size_t i = 0; i < pieces && best.distance > 0.0; ++i) {
      const auto count = static_cast<double>(pieces);
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
  AlignedBox3d extent = impl_->extent;
  if (impl_->is_bounded()) extent.extend(impl_->region);
  return extent;
}

std::string MeasuredSpace::name(const Closest& closest) const {
  if (closest.kind == ObstacleKind::unknown_space) return "space that was never seen free";
  if (closest.kind == ObstacleKind::occupied_space) return "a measured point";
  return "";
}

double MeasuredSpace::free_volume() const {
  std::size_t voxels = 0;
  for (const auto& [key, block] : impl_->blocks) {
    for (int z = 0; z < 8; ++z)
      voxels += static_cast<std::size_t>(std::popcount(block.passable(z)));
  }
  return static_cast<double>(voxels) * std::pow(impl_->config.voxel, 3);
}

namespace {

constexpr char file_mark[16] = "skycap free v1\n";

/// What a file begins with. Plain numbers: it is written as it is in memory.
struct FileHead {
  char mark[16];
  double voxel, depth_margin, free_without_return, max_depth, floor;
  double region[6];  ///< its two corners; the first above the second if there is none
  std::uint64_t blocks;
};

struct FileBlock {
  std::uint64_t key;
  VoxelBlock block;
};

template <typename Record>
bool read_record(std::istream& stream, Record& record) {
  return bool(stream.read(reinterpret_cast<char*>(&record), sizeof record));
}

Cell cell_of(std::uint64_t key) {
  const auto part = [](std::uint64_t bits) {
    return static_cast<int>(bits & 0x1fffff) - (1 << 20);
  };
  return {part(key), part(key >> 21), part(key >> 42)};
}

}  // namespace

void MeasuredSpace::write(std::ostream& stream) const {
  const MeasuredSpaceConfig& config = impl_->config;
  FileHead head{};
  std::memcpy(head.mark, file_mark, sizeof head.mark);
  head.voxel = config.voxel, head.depth_margin = config.depth_margin;
  head.free_without_return = config.free_without_return, head.max_depth = config.max_depth;
  head.floor = config.floor;
  for (int axis = 0; axis < 3; ++axis) {
    head.region[axis] = config.region.min()[axis];
    head.region[axis + 3] = config.region.max()[axis];
  }
  head.blocks = impl_->blocks.size();
  stream.write(reinterpret_cast<const char*>(&head), sizeof head);

  // By place, so that equal spaces give equal files.
  std::vector<FileBlock> blocks;
  blocks.reserve(impl_->blocks.size());
  for (const auto& [key, block] : impl_->blocks) blocks.push_back({key, block});
  std::ranges::sort(blocks, {}, &FileBlock::key);
  stream.write(reinterpret_cast<const char*>(blocks.data()),
               static_cast<std::streamsize>(blocks.size() * sizeof(FileBlock)));
}

MeasuredSpace MeasuredSpace::read(std::istream& stream, const std::string& name) {
  FileHead head{};
  if (!read_record(stream, head) || std::memcmp(head.mark, file_mark, sizeof head.mark) != 0) {
    throw Error(ErrorKind::bad_file,
                name + ": is not a file of measured free space; give one that skycap plan wrote");
  }
  MeasuredSpaceConfig config{.voxel = head.voxel,
                             .depth_margin = head.depth_margin,
                             .free_without_return = head.free_without_return,
                             .max_depth = head.max_depth,
                             .region = {},
                             .floor = head.floor};
  const AlignedBox3d region(Eigen::Map<const Vector3d>(head.region),
                            Eigen::Map<const Vector3d>(head.region + 3));
  if (!region.isEmpty()) config.region = region;
  try {
    MeasuredSpace space(config);
    FileBlock record{};
    for (std::uint64_t i = 0; i < head.blocks; ++i) {
      if (!read_record(stream, record)) {
        throw Error(ErrorKind::bad_file, name + ": ends after " + std::to_string(i) + " of " +
                                             std::to_string(head.blocks) +
                                             " blocks; copy it again, or plan again");
      }
      space.impl_->blocks[record.key] = record.block;
      space.impl_->extent.extend(space.impl_->block_box(cell_of(record.key)));
    }
    if (stream.peek() != std::istream::traits_type::eof()) {
      throw Error(ErrorKind::bad_file, name + ": goes on after its last block; plan again");
    }
    return space;
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::bad_file) throw;
    throw Error(ErrorKind::bad_file, name + ": " + error.what());
  }
}

}  // namespace skycap::flight
