#include "survey/scan_voxels.h"

#include <sstream>

#include "geometry/error.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3f;

}  // namespace

ScanVoxels::ScanVoxels(const Vector3f& origin, std::span<const Vector3f> returns,
                       std::span<const Vector3f> empty_ends, double resolution)
    : resolution_(resolution) {
  low_ = voxel_at(origin, 1.0 / resolution);
  VoxelIndex high = low_;
  for (const auto ends : {returns, empty_ends}) {
    for (const Vector3f& end : ends) {
      const VoxelIndex voxel = voxel_at(end, 1.0 / resolution);
      for (int axis = 0; axis < 3; ++axis) {
        low_[axis] = std::min(low_[axis], voxel[axis]);
        high[axis] = std::max(high[axis], voxel[axis]);
      }
    }
  }
  // Rounding may lead a ray past the voxel of its end, by one voxel on some axis.
  double voxels = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    low_[axis] -= 1;
    const std::int64_t width = std::int64_t{high[axis]} - low_[axis] + 2;
    voxels *= static_cast<double>(width);
    if (axis < 2) strides_[axis + 1] = strides_[axis] * width;
  }
  if (voxels > most_voxels) {
    std::ostringstream message;
    message << "a scan spans " << voxels << " voxels of " << resolution
            << " m; choose a larger planner.resolution_radius, or a smaller sensor.max_range";
    throw Error(ErrorKind::bad_config, message.str());
  }
  marks_.resize((static_cast<std::size_t>(voxels) / 8 + 1) * 8);

  mark_passed(origin, returns);
  mark_passed(origin, empty_ends);
  for (const Vector3f& point : returns) {
    marks_[static_cast<std::size_t>(number_of(voxel_at(point, 1.0 / resolution)))] = hit;
  }
}

void ScanVoxels::mark_passed(const Vector3f& origin, std::span<const Vector3f> ends) {
  const auto start = static_cast<std::size_t>(number_of(voxel_at(origin, 1.0 / resolution_)));
  for (const Vector3f& end : ends) {
    const VoxelLine::Steps steps = VoxelLine(origin, end, resolution_).steps();
    std::uint8_t* mark = marks_.data() + start;
    std::int64_t x = steps.border[0], y = steps.border[1], z = steps.border[2];
    const std::int64_t x_spacing = steps.spacing[0];
    const std::int64_t y_spacing = steps.spacing[1];
    const std::int64_t z_spacing = steps.spacing[2];
    const std::int64_t x_stride = steps.sense[0] * strides_[0];
    const std::int64_t y_stride = steps.sense[1] * strides_[1];
    const std::int64_t z_stride = steps.sense[2] * strides_[2];
    // Processors guess these branches well, because the ray before went much the same way. Without
    // branches, each step would wait for all comparisons of the last: four times as long.
    const auto advance = [&] {
      if (x < y && x < z) {
        x += x_spacing;
        mark += x_stride;
      } else if (y < z) {
        y += y_spacing;
        mark += y_stride;
      } else {
        z += z_spacing;
        mark += z_stride;
      }
    };
    for (std::int64_t step = 0; step < steps.surely_passed; ++step) {
      *mark = passed;
      advance();
    }
    for (std::int64_t step = steps.surely_passed; step < steps.most; ++step) {
      if (step > 0 && std::min({x, y, z}) > steps.limit) break;
      *mark = passed;
      advance();
    }
  }
}

}  // namespace skycap::survey
