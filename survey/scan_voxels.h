/// Which voxels the rays of one scan pass and hit, each once.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "survey/voxel_walk.h"

namespace skycap::survey {

/// A byte for each voxel of a box around the scan. A million rays take half a thousand steps each,
/// so a step has to cost little: it only writes, and never waits for what another step wrote.
class ScanVoxels {
 public:
  /// Of rays from `origin`, in the world frame. The voxels of `returns` are hit; those before them
  /// and before `empty_ends` are passed. Throws if the scan spans more than most_voxels.
  ScanVoxels(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> returns,
             std::span<const Eigen::Vector3f> empty_ends, double resolution);

  static constexpr double most_voxels = 0x1p33;  // 8 GiB

  /// Calls f(voxel, is_hit) for all that are passed or hit, in a fixed order.
  template <typename F>
  void for_each(F f) const {
    for (std::size_t eight = 0; eight < marks_.size(); eight += 8) {
      std::uint64_t any = 0;
      std::memcpy(&any, &marks_[eight], 8);
      if (any == 0) continue;
      for (std::size_t number = eight; number < eight + 8; ++number) {
        if (marks_[number] != 0) f(voxel_of(number), marks_[number] == hit);
      }
    }
  }

 private:
  static constexpr std::uint8_t passed = 1, hit = 2;

  std::int64_t number_of(const VoxelIndex& voxel) const {
    return (voxel[0] - low_[0]) + (voxel[1] - low_[1]) * strides_[1] +
           (voxel[2] - low_[2]) * strides_[2];
  }
  VoxelIndex voxel_of(std::size_t number) const {
    const auto n = static_cast<std::int64_t>(number);
    return {low_[0] + static_cast<std::int32_t>(n % strides_[1]),
            low_[1] + static_cast<std::int32_t>(n % strides_[2] / strides_[1]),
            low_[2] + static_cast<std::int32_t>(n / strides_[2])};
  }
  void mark_passed(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> ends);

  double resolution_;
  VoxelIndex low_{};                        // of the box
  std::array<std::int64_t, 3> strides_{1};  // from a voxel's number to its neighbours'
  std::vector<std::uint8_t> marks_;         // a multiple of eight
};

}  // namespace skycap::survey
