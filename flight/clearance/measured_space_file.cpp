#include "flight/clearance/measured_space_file.h"

#include <algorithm>
#include <cstring>
#include <istream>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "flight/clearance/measured_voxels.h"
#include "geometry/error.h"
#include "geometry/pose/world.h"

namespace skycap::flight {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr char file_mark[16] = "skycap free v1\n";
/// About 1 GB, for a survey of about 10^10 voxels.
constexpr std::uint64_t max_blocks = 8'000'000;
constexpr double no_floor = -std::numeric_limits<double>::infinity();

/// File header. Plain numbers, written as in memory.
struct FileHead {
  char mark[16];
  double voxel, depth_margin, free_without_return, max_depth;
  double floor;      ///< Height, or no_floor.
  double region[6];  ///< Two corners. Without a region, the first is above the second.
  std::uint64_t blocks;
};

template <typename Record>
bool read_record(std::istream& stream, Record& record) {
  return bool(stream.read(reinterpret_cast<char*>(&record), sizeof record));
}

}  // namespace

void MeasuredSpace::write(std::ostream& stream) const {
  const MeasuredSpaceConfig& config = impl_->config;
  FileHead head{};
  std::memcpy(head.mark, file_mark, sizeof head.mark);
  head.voxel = config.voxel, head.depth_margin = config.depth_margin;
  head.free_without_return = config.free_without_return, head.max_depth = config.max_depth;
  head.floor = config.floor.value_or(no_floor);
  for (int axis = 0; axis < 3; ++axis) {
    head.region[axis] = config.region.min()[axis];
    head.region[axis + 3] = config.region.max()[axis];
  }
  head.blocks = impl_->blocks.size();
  stream.write(reinterpret_cast<const char*>(&head), sizeof head);

  // Sorted by position, so that equal spaces give equal files.
  std::vector<FileBlock> blocks;
  blocks.reserve(impl_->blocks.size());
  for (std::size_t i = 0; i < impl_->blocks.size(); ++i) {
    blocks.push_back({impl_->blocks.keys()[i], impl_->blocks.blocks()[i]});
  }
  std::ranges::sort(blocks, {}, &FileBlock::key);
  stream.write(reinterpret_cast<const char*>(blocks.data()),
               static_cast<std::streamsize>(blocks.size() * sizeof(FileBlock)));
}

MeasuredSpaceFile read_measured_space(std::istream& stream, const std::string& name) {
  FileHead head{};
  if (!read_record(stream, head) || std::memcmp(head.mark, file_mark, sizeof head.mark) != 0) {
    throw Error(ErrorKind::bad_file,
                name + ": is not a free-space file; use one written by skycap plan");
  }
  MeasuredSpaceFile file{.config = {.voxel = head.voxel,
                                    .depth_margin = head.depth_margin,
                                    .free_without_return = head.free_without_return,
                                    .max_depth = head.max_depth,
                                    .region = {},
                                    .floor = {}},
                         .blocks = {}};
  if (head.floor != no_floor) file.config.floor = head.floor;
  const AlignedBox3d region(Eigen::Map<const Vector3d>(head.region),
                            Eigen::Map<const Vector3d>(head.region + 3));
  if (!region.isEmpty()) file.config.region = region;
  try {
    file.config.validate();
  } catch (const Error& error) {
    throw Error(ErrorKind::bad_file, name + ": " + error.what());
  }
  if (head.blocks > max_blocks) {
    throw Error(ErrorKind::bad_file, name + ": is damaged: its header declares " +
                                         std::to_string(head.blocks) + " blocks; at most " +
                                         std::to_string(max_blocks) + " are allowed");
  }
  FileBlock block{};
  for (std::uint64_t i = 0; i < head.blocks; ++i) {
    if (!read_record(stream, block)) {
      throw Error(ErrorKind::bad_file,
                  name + ": is truncated after " + std::to_string(i) + " of " +
                      std::to_string(head.blocks) +
                      " blocks; restore it from a copy, or plan the mission again");
    }
    const Vector3d low = unpack_cell(block.key).cast<double>() * 8.0 * head.voxel;
    if (!geometry::is_valid_position(low)) {
      throw Error(ErrorKind::bad_file,
                  name + ": is damaged: block " + std::to_string(i) +
                      " is more than 10,000 km from the origin; plan the mission again");
    }
    file.blocks.push_back(block);
  }
  if (stream.peek() != std::istream::traits_type::eof()) {
    throw Error(ErrorKind::bad_file,
                name + ": is damaged: data after the last block; plan the mission again");
  }
  return file;
}

MeasuredSpace MeasuredSpace::read(std::istream& stream, const std::string& name) {
  const MeasuredSpaceFile file = read_measured_space(stream, name);
  MeasuredSpace space(file.config);
  for (const FileBlock& record : file.blocks) {
    const Cell cell = unpack_cell(record.key);  // Ignores any further bits of the key.
    space.impl_->set(cell, record.block);
  }
  return space;
}

}  // namespace skycap::flight
