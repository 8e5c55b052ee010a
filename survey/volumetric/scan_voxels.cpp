#include "survey/volumetric/scan_voxels.h"

#include <algorithm>
#include <sstream>

#include "geometry/error.h"
#include "survey/vector_clones.h"

namespace skycap::survey::volumetric {
namespace {

using Eigen::Vector3f;
using Mark = ScanVoxels::Mark;

constexpr std::size_t lane_count = 4;
using Lanes [[gnu::vector_size(lane_count * sizeof(std::int64_t))]] = std::int64_t;
// A comparison of lanes returns -1 for true and 0 for false.

/// State of four rays that step through voxels.
struct FourWalks {
  Lanes number{};                  // current voxels
  std::array<Lanes, 3> border{};   // next border crossing on each axis
  std::array<Lanes, 3> spacing{};  // distance between borders
  std::array<Lanes, 3> stride{};   // index difference between adjacent voxels
};

/// Marks the next `steps` voxels of each ray as passed.
[[gnu::always_inline]] inline void pass_four_body(FourWalks& walks, std::int64_t steps,
                                                  Mark* marks) {
  Lanes x = walks.border[0], y = walks.border[1], z = walks.border[2], number = walks.number;
  const Lanes x_spacing = walks.spacing[0], x_stride = walks.stride[0];
  const Lanes y_spacing = walks.spacing[1], y_stride = walks.stride[1];
  const Lanes z_spacing = walks.spacing[2], z_stride = walks.stride[2];
  for (std::int64_t step = 0; step < steps; ++step) {
    for (std::size_t lane = 0; lane < lane_count; ++lane) marks[number[lane]] = ScanVoxels::passed;
    const Lanes on_x = (x < y) & (x < z);
    const Lanes on_y = ~on_x & (y < z);
    const Lanes on_z = ~(on_x | on_y);
    x += on_x & x_spacing;
    y += on_y & y_spacing;
    z += on_z & z_spacing;
    number += (on_x & x_stride) | (on_y & y_stride) | (on_z & z_stride);
  }
  walks.border[0] = x, walks.border[1] = y, walks.border[2] = z, walks.number = number;
}
void pass_four_anywhere(FourWalks& walks, std::int64_t steps, Mark* marks) {
  pass_four_body(walks, steps, marks);
}
SKYCAP_FOR_AVX2 void pass_four_with_avx2(FourWalks& walks, std::int64_t steps, Mark* marks) {
  pass_four_body(walks, steps, marks);
}

/// Returns the end of the shadow of a point.
Vector3f compute_shadow_end(const Vector3f& origin, const Vector3f& point, double length) {
  const Vector3f ray = point - origin;
  const float distance = ray.norm();
  if (distance == 0.0F) return point;
  return point + ray * (static_cast<float>(length) / distance);
}

/// State of one ray.
struct Walk {
  Walk(const VoxelLine::Steps& steps, const std::array<std::int64_t, 3>& strides, Mark* first)
      : mark(first), border(steps.border) {
    for (int axis = 0; axis < 3; ++axis) stride[axis] = steps.sense[axis] * strides[axis];
  }

  Mark* mark;
  std::int64_t step = 0;
  std::array<std::int64_t, 3> border;
  std::array<std::int64_t, 3> stride{};
};

/// Calls `visit` with the marks of the remaining voxels in order.
template <typename Visit>
void finish(const Walk& walk, const VoxelLine::Steps& steps, Visit visit) {
  Mark* mark = walk.mark;
  std::int64_t x = walk.border[0], y = walk.border[1], z = walk.border[2];
  // Branch prediction works well here if the previous ray had a similar direction.
  const auto advance = [&] {
    if (x < y && x < z) {
      x += steps.spacing[0];
      mark += walk.stride[0];
    } else if (y < z) {
      y += steps.spacing[1];
      mark += walk.stride[1];
    } else {
      z += steps.spacing[2];
      mark += walk.stride[2];
    }
  };
  std::int64_t step = walk.step;
  for (; step < steps.surely_passed; ++step) {
    visit(*mark);
    advance();
  }
  for (; step < steps.max; ++step) {
    if (step > 0 && std::min({x, y, z}) > steps.limit) break;
    visit(*mark);
    advance();
  }
}

}  // namespace

ScanVoxels::ScanVoxels(const Vector3f& origin, std::span<const Vector3f> returns,
                       std::span<const Vector3f> empty_ends, double resolution,
                       double shadow_length)
    : resolution_(resolution) {
  low_ = voxel_at(origin, 1.0 / resolution);
  VoxelIndex high = low_;
  const auto extend = [&](const Vector3f& point) {
    const VoxelIndex voxel = voxel_at(point, 1.0 / resolution);
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = std::min(low_[axis], voxel[axis]);
      high[axis] = std::max(high[axis], voxel[axis]);
    }
  };
  for (const Vector3f& point : returns) {
    extend(point);
    extend(compute_shadow_end(origin, point, shadow_length));
  }
  for (const Vector3f& end : empty_ends) extend(end);
  // Due to rounding, a ray may pass its end by one voxel per axis.
  double voxels = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    low_[axis] -= 1;
    std::int64_t width = std::int64_t{high[axis]} - low_[axis] + 2;
    if (axis == 0) width = (width + marks_in_word - 1) / marks_in_word * marks_in_word;
    voxels *= static_cast<double>(width);
    if (axis < 2) strides_[axis + 1] = strides_[axis] * width;
  }
  if (voxels > max_voxels) {
    std::ostringstream message;
    message << "a scan spans " << voxels << " voxels of " << resolution
            << " m; raise planner.resolution_radius or lower sensor.max_range";
    throw Error(ErrorKind::bad_config, message.str());
  }
  marks_.resize(static_cast<std::size_t>(voxels));

  // Measurements override shadows, and hits override passed voxels.
  for (const Vector3f& point : returns) mark_shadow(origin, point, shadow_length);
  mark_passed(origin, returns);
  mark_passed(origin, empty_ends);
  for (const Vector3f& point : returns) {
    marks_[static_cast<std::size_t>(linear_index(voxel_at(point, 1.0 / resolution)))] = hit;
  }
}

void ScanVoxels::mark_shadow(const Vector3f& origin, const Vector3f& point, double length) {
  const auto steps =
      VoxelLine(point, compute_shadow_end(origin, point, length), resolution_).steps();
  Mark* const first = marks_.data() + linear_index(voxel_at(point, 1.0 / resolution_));
  Mark depth = 0;
  finish(Walk(steps, strides_, first), steps, [&](Mark& mark) {
    // Zero (no mark) underflows to the maximum value.
    mark = static_cast<Mark>(std::min<Mark>(mark - 1, depth - 1) + 1);
    ++depth;
  });
}

void ScanVoxels::mark_passed(const Vector3f& origin, std::span<const Vector3f> ends) {
  const auto pass = [](Mark& mark) { mark = passed; };
  const auto pass_four = has_avx2() ? pass_four_with_avx2 : pass_four_anywhere;
  const std::int64_t start = linear_index(voxel_at(origin, 1.0 / resolution_));
  std::size_t next = 0;
  for (; next + lane_count <= ends.size(); next += lane_count) {
    std::array<VoxelLine::Steps, lane_count> steps;
    FourWalks walks;
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      steps[lane] = VoxelLine(origin, ends[next + lane], resolution_).steps();
      for (int axis = 0; axis < 3; ++axis) {
        walks.border[axis][lane] = steps[lane].border[axis];
        walks.spacing[axis][lane] = steps[lane].spacing[axis];
        walks.stride[axis][lane] = steps[lane].sense[axis] * strides_[axis];
      }
      walks.number[lane] = start;
    }
    const std::int64_t together =
        std::ranges::min(steps, {}, &VoxelLine::Steps::surely_passed).surely_passed;
    pass_four(walks, together, marks_.data());
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      Walk walk(steps[lane], strides_, marks_.data() + walks.number[lane]);
      walk.step = together;
      for (int axis = 0; axis < 3; ++axis) walk.border[axis] = walks.border[axis][lane];
      finish(walk, steps[lane], pass);
    }
  }
  for (; next < ends.size(); ++next) {
    const auto steps = VoxelLine(origin, ends[next], resolution_).steps();
    finish(Walk(steps, strides_, marks_.data() + start), steps, pass);
  }
}

}  // namespace skycap::survey::volumetric
