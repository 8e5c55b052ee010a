/// The volumetric planners' map and gains once more, on OctoMap and without any thought of speed:
/// every ray is cast, then its voxels are listed, then each is looked up from the root of the tree.
/// An independent twin for tests, and what benchmarks compare with.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <octomap/OcTreeNode.h>
#include <octomap/OccupancyOcTreeBase.h>

#include "geometry/pose/pose.h"
#include "survey/volumetric/volumetric_gain.h"

namespace skycap::tests {

/// A voxel that may also be in a shadow.
class ShadowNode : public octomap::OcTreeNode {
 public:
  int shadow_depth = 0;  ///< cells behind the surface; 0: in no shadow
  bool is_measured = true;
};

class ShadowTree : public octomap::OccupancyOcTreeBase<ShadowNode> {
 public:
  ShadowTree(double resolution, double shadow_length);
  std::string getTreeType() const override { return "ShadowTree"; }
  ShadowTree* create() const override { return new ShadowTree(resolution, shadow_length_); }

  void insert(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> points);
  /// The gain of a view. The published evaluation code casts each ray, and then takes the voxels on
  /// the way to the centre of the voxel that it met; with `aims_at_centres` this does the same.
  double gain(survey::volumetric::VolumetricMetric metric, const geometry::View& view,
              const std::vector<Eigen::Vector3d>& directions, double depth,
              bool aims_at_centres) const;

 private:
  void measure(const octomap::OcTreeKey& key, bool is_hit);

  double shadow_length_;
};

}  // namespace skycap::tests
