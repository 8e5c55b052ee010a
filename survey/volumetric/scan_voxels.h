/// Voxels that the rays of one scan pass, hit or leave in the shadow, each listed once.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "survey/volumetric/voxel_walk.h"

namespace skycap::survey::volumetric {

/// Marks of all voxels of a box around the scan. A million rays have about 500 steps each, so a
/// step must be cheap: it only writes and never depends on an earlier write.
class ScanVoxels {
 public:
  /// Mark of a voxel: `passed`, `hit`, or its depth behind the nearest surface in front of it
  /// [voxels].
  using Mark = std::uint16_t;
  static constexpr Mark passed = 0xfffe, hit = 0xffff;
  static bool is_shadow(Mark mark) { return mark < passed; }

  /// Marks the voxels of rays from `origin` in the world frame. The voxels of `returns` are hit,
  /// those before `returns` and `empty_ends` are passed. Shadows extend `shadow_length` [m] behind
  /// returns, less than 30,000 voxels. Throws if the scan spans more than max_voxels.
  ScanVoxels(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> returns,
             std::span<const Eigen::Vector3f> empty_ends, double resolution, double shadow_length);

  static constexpr double max_voxels = 0x1p32;  // 8 GiB of marks

  /// Calls f(voxel, mark) for all marked voxels in a fixed order.
  template <typename F>
  void for_each(F f) const {
    std::size_t row = 0;
    VoxelIndex voxel = low_;
    for (; row < marks_.size(); row += static_cast<std::size_t>(strides_[1])) {
      for (std::int64_t x = 0; x < strides_[1]; x += marks_in_word) {
        std::uint64_t any = 0;
        std::memcpy(&any, &marks_[row + static_cast<std::size_t>(x)], sizeof any);
        if (any == 0) continue;
        for (std::int64_t i = x; i < x + marks_in_word; ++i) {
          voxel[0] = low_[0] + static_cast<std::int32_t>(i);
          const Mark mark = marks_[row + static_cast<std::size_t>(i)];
          if (mark != 0) f(voxel, mark);
        }
      }
      ++voxel[1];
      if ((voxel[1] - low_[1]) * strides_[1] < strides_[2]) continue;
      voxel[1] = low_[1];
      ++voxel[2];
    }
  }

 private:
  static constexpr std::int64_t marks_in_word = sizeof(std::uint64_t) / sizeof(Mark);

  std::int64_t linear_index(const VoxelIndex& voxel) const {
    return (voxel[0] - low_[0]) + (voxel[1] - low_[1]) * strides_[1] +
           (voxel[2] - low_[2]) * strides_[2];
  }
  void mark_shadow(const Eigen::Vector3f& origin, const Eigen::Vector3f& point, double length);
  void mark_passed(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> ends);

  double resolution_;
  VoxelIndex low_{};                        // minimum corner of the box
  std::array<std::int64_t, 3> strides_{1};  // index difference between adjacent voxels on each axis
  std::vector<Mark> marks_;
};

}  // namespace skycap::survey::volumetric
