#include "survey/pb_nbv/voxel_labels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace skycap::survey::pb_nbv {

using Eigen::Vector3d;
using Eigen::Vector3i;

// Amanatides & Woo, A fast voxel traversal algorithm (1987).
void walk_ray(const Vector3d& origin, const Vector3d& direction, double begin, double end,
              double voxel, const std::function<bool(const Vector3i&)>& visit) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Vector3d entry = origin + begin * direction;
  Vector3i cell = (entry / voxel).array().floor().cast<int>();
  Vector3i step;
  Vector3d next, per_cell;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = direction[axis];
    step[axis] = along > 0.0 ? 1 : along < 0.0 ? -1 : 0;
    const double border = voxel * (cell[axis] + (along > 0.0 ? 1 : 0));
    next[axis] = along == 0.0 ? infinity : (border - origin[axis]) / along;
    per_cell[axis] = along == 0.0 ? infinity : voxel / std::abs(along);
  }
  for (;;) {
    if (!visit(cell)) return;
    int axis = next[1] < next[0] ? 1 : 0;
    if (next[2] < next[axis]) axis = 2;
    if (next[axis] >= end) return;
    cell[axis] += step[axis];
    next[axis] += per_cell[axis];
  }
}

RayInterval clip_ray(const Vector3d& origin, const Vector3d& direction,
                     const Eigen::AlignedBox3d& box) {
  RayInterval interval{0.0, std::numeric_limits<double>::infinity()};
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < box.min()[axis] || origin[axis] > box.max()[axis]) return {};
      continue;
    }
    double near = (box.min()[axis] - origin[axis]) / direction[axis];
    double far = (box.max()[axis] - origin[axis]) / direction[axis];
    if (near > far) std::swap(near, far);
    interval.begin = std::max(interval.begin, near);
    interval.end = std::min(interval.end, far);
  }
  return interval;
}

std::size_t VoxelLabels::offset(const Vector3i& index) const {
  const Vector3i at = index - origin_;
  return (static_cast<std::size_t>(at.z()) * static_cast<std::size_t>(size_.y()) +
          static_cast<std::size_t>(at.y())) *
             static_cast<std::size_t>(size_.x()) +
         static_cast<std::size_t>(at.x());
}

Label VoxelLabels::at(const Vector3i& index) const {
  return contains(index) ? labels_[offset(index)] : Label::none;
}

void VoxelLabels::grow_to(const Vector3i& index) {
  constexpr int margin = 4;  // grows rarely
  VoxelLabels grown(voxel_);
  const Vector3i low = index.array() - margin, high = index.array() + margin + 1;
  if (labels_.empty()) {
    grown.origin_ = low;
    grown.size_ = high - low;
  } else {
    grown.origin_ = origin_.cwiseMin(low);
    grown.size_ = (origin_ + size_).cwiseMax(high) - grown.origin_;
  }
  grown.labels_.assign(static_cast<std::size_t>(grown.size_.x()) *
                           static_cast<std::size_t>(grown.size_.y()) *
                           static_cast<std::size_t>(grown.size_.z()),
                       Label::none);
  for (int z = 0; z < size_.z(); ++z) {
    for (int y = 0; y < size_.y(); ++y) {
      for (int x = 0; x < size_.x(); ++x) {
        const Vector3i at = origin_ + Vector3i(x, y, z);
        grown.labels_[grown.offset(at)] = labels_[offset(at)];
      }
    }
  }
  *this = std::move(grown);
}

void VoxelLabels::set(const Vector3i& index, Label label) {
  if (!contains(index)) grow_to(index);
  labels_[offset(index)] = label;
}

void VoxelLabels::insert_ray(const Vector3d& origin, const Vector3d& direction,
                             const RayInterval& interval) {
  if (interval.begin > interval.end) return;
  bool is_behind = false;
  walk_ray(origin, direction, interval.begin, interval.end, voxel_, [&](const Vector3i& index) {
    const Label label = at(index);
    if (label == Label::occupied) {
      is_behind = true;
    } else if (is_behind) {
      if (label == Label::none) set(index, Label::unknown);
    } else if (label != Label::empty) {
      set(index, Label::empty);
    }
    return true;
  });
}

std::vector<Vector3i> VoxelLabels::with_label(Label label) const {
  std::vector<Vector3i> found;
  for (int z = 0; z < size_.z(); ++z) {
    for (int y = 0; y < size_.y(); ++y) {
      for (int x = 0; x < size_.x(); ++x) {
        const Vector3i index = origin_ + Vector3i(x, y, z);
        if (labels_[offset(index)] == label) found.push_back(index);
      }
    }
  }
  return found;
}

std::vector<Vector3i> VoxelLabels::frontiers() const {
  std::vector<Vector3i> found;
  for (const Vector3i& index : with_label(Label::unknown)) {
    bool has_empty = false, has_occupied = false;
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const Label label = at(index + Vector3i(x, y, z));
          has_empty |= label == Label::empty;
          has_occupied |= label == Label::occupied;
        }
      }
    }
    if (has_empty && has_occupied) found.push_back(index);
  }
  return found;
}

}  // namespace skycap::survey::pb_nbv
