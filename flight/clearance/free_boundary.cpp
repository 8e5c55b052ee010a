#include "flight/clearance/free_boundary.h"

#include <bit>
#include <unordered_map>

#include "flight/clearance/measured_space_file.h"
#include "flight/clearance/measured_voxels.h"

namespace skycap::flight {
namespace {

/// One of the six neighbours of a voxel or block.
struct Side {
  int axis;
  bool is_up;
};

constexpr Side sides[] = {{0, false}, {0, true}, {1, false}, {1, true}, {2, false}, {2, true}};

Cell step(const Side& side) { return Cell::Unit(side.axis) * (side.is_up ? 1 : -1); }

/// Returns, for each voxel of a block, the bit of its neighbour on a side, possibly from the next
/// block.
Slices shift_slices(const Slices& own, const Slices& next, const Side& side) {
  constexpr std::uint64_t first_column = 0x0101010101010101ULL, last_column = first_column << 7;
  Slices moved{};
  for (int z = 0; z < 8; ++z) {
    if (side.axis == 0) {
      moved[z] = side.is_up ? (own[z] & ~first_column) >> 1 | (next[z] & first_column) << 7
                            : (own[z] & ~last_column) << 1 | (next[z] & last_column) >> 7;
    } else if (side.axis == 1) {
      moved[z] = side.is_up ? own[z] >> 8 | next[z] << 56 : own[z] << 8 | next[z] >> 56;
    } else if (side.is_up) {
      moved[z] = z < 7 ? own[z + 1] : next[0];
    } else {
      moved[z] = z > 0 ? own[z - 1] : next[7];
    }
  }
  return moved;
}

using Blocks = std::unordered_map<std::uint64_t, const VoxelBlock*>;

/// Adds the faces of a block's free voxels.
void add_faces(const FileBlock& record, const Blocks& blocks, const MeasuredSpaceConfig& config,
               std::vector<Eigen::Vector3f>& faces) {
  const VoxelRegion region = voxel_region(config.region, config.voxel);
  const Cell cell = unpack_cell(record.key);
  const auto blocked = [&](const Cell& neighbour) {
    const auto found = blocks.find(cell_key(neighbour));
    return blocked_voxels({&region, 1}, neighbour,
                          found == blocks.end() ? VoxelBlock{} : *found->second);
  };
  const Slices own = blocked(cell);
  for (const Side& side : sides) {
    const Slices beyond = shift_slices(own, blocked(cell + step(side)), side);
    const Eigen::Vector3d to_face = 0.5 * (Eigen::Vector3d::Ones() + step(side).cast<double>());
    for (int z = 0; z < 8; ++z) {
      for (std::uint64_t bits = record.block.passable(z) & beyond[z]; bits != 0; bits &= bits - 1) {
        const int bit = std::countr_zero(bits);
        const Eigen::Vector3d voxel = (8 * cell + Cell(bit % 8, bit / 8, z)).cast<double>();
        faces.emplace_back((config.voxel * (voxel + to_face)).cast<float>());
      }
    }
  }
}

}  // namespace

std::vector<Eigen::Vector3f> free_boundary(std::istream& stream, const std::string& name) {
  const MeasuredSpaceFile file = read_measured_space(stream, name);
  Blocks blocks;
  blocks.reserve(file.blocks.size());
  for (const FileBlock& record : file.blocks) blocks[record.key] = &record.block;
  std::vector<Eigen::Vector3f> faces;
  for (const FileBlock& record : file.blocks) add_faces(record, blocks, file.config, faces);
  return faces;
}

}  // namespace skycap::flight
