/// Voxel map of PB-NBV with a label per voxel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skycap::survey::pb_nbv {

enum class Label : std::uint8_t { none, occupied, empty, unknown };

/// Visits the voxels of size `voxel` that the ray origin + t direction crosses between `begin` and
/// `end`, in order, until `visit` returns false.
void walk_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double begin,
              double end, double voxel, const std::function<bool(const Eigen::Vector3i&)>& visit);

/// Returns the interval of t in which origin + t direction is inside the box, with t >= 0. The
/// interval is empty if begin > end.
struct RayInterval {
  double begin = 0.0;
  double end = -1.0;
};
RayInterval clip_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                     const Eigen::AlignedBox3d& box);

/// Labels of the voxels around the scene. Voxels outside the stored block are `none`. The block
/// grows when a voxel outside it is set.
class VoxelLabels {
 public:
  explicit VoxelLabels(double voxel) : voxel_(voxel) {}

  double voxel() const { return voxel_; }
  Eigen::Vector3i index(const Eigen::Vector3d& point) const {
    return (point / voxel_).array().floor().cast<int>();
  }
  Eigen::Vector3d centre(const Eigen::Vector3i& index) const {
    return voxel_ * (index.cast<double>().array() + 0.5).matrix();
  }

  Label at(const Eigen::Vector3i& index) const;
  void set(const Eigen::Vector3i& index, Label label);

  /// Labels the voxels of a ray: before the first occupied voxel empty, behind it unknown. Occupied
  /// voxels are not changed, and unknown does not replace empty.
  void insert_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                  const RayInterval& interval);

  /// Returns the indices of the voxels with a label, in order of z, y and x.
  std::vector<Eigen::Vector3i> with_label(Label label) const;

  /// Returns the unknown voxels with an empty and an occupied one among their 26 neighbours, in the
  /// same order.
  std::vector<Eigen::Vector3i> frontiers() const;

 private:
  bool contains(const Eigen::Vector3i& index) const {
    return (index.array() >= origin_.array()).all() &&
           (index.array() < (origin_ + size_).array()).all();
  }
  std::size_t offset(const Eigen::Vector3i& index) const;
  void grow_to(const Eigen::Vector3i& index);

  double voxel_;
  Eigen::Vector3i origin_ = Eigen::Vector3i::Zero(), size_ = Eigen::Vector3i::Zero();
  std::vector<Label> labels_;
};

}  // namespace skycap::survey::pb_nbv
