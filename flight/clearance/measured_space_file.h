/// File content of measured space. Internal to measured_space.h and free_boundary.h.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "flight/clearance/measured_space.h"
#include "flight/clearance/voxel_block.h"

namespace skycap::flight {

struct FileBlock {
  std::uint64_t key;  ///< Key of the block's cell.
  VoxelBlock block;
};

struct MeasuredSpaceFile {
  MeasuredSpaceConfig config;
  std::vector<FileBlock> blocks;
};

/// Throws the same errors as MeasuredSpace::read().
MeasuredSpaceFile read_measured_space(std::istream& stream, const std::string& name);

}  // namespace skycap::flight
