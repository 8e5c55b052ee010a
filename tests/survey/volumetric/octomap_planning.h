/// Reference implementation of the volumetric planners' map and gains on OctoMap, without
/// optimisations. Each ray is cast, its voxels are listed, and each voxel is looked up from the
/// root of the tree. Used in tests and benchmarks.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <octomap/OcTreeNode.h>
#include <octomap/OccupancyOcTreeBase.h>

#include "geometry/pose/pose.h"
#include "survey/volumetric/volumetric_gain.h"

namespace skycap::tests {

/// Voxel that may also be in a shadow.
class ShadowNode : public octomap::OcTreeNode {
 public:
  int shadow_depth = 0;  ///< number of cells behind the surface; 0: not in a shadow
  bool is_measured = true;
};

class ShadowTree : public octomap::OccupancyOcTreeBase<ShadowNode> {
 public:
  ShadowTree(double resolution, double shadow_length);
  std::string getTreeType() const override { return "ShadowTree"; }
  ShadowTree* create() const override { return new ShadowTree(resolution, shadow_length_); }

  void insert(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> points);
  /// Returns the gain of a view. The published evaluation code casts each ray, and then uses the
  /// voxels on the path to the centre of the voxel that was hit. `aims_at_centres` selects this
  /// behaviour.
  double gain(survey::volumetric::VolumetricMetric metric, const geometry::View& view,
              const std::vector<Eigen::Vector3d>& directions, double depth,
              bool aims_at_centres) const;

 private:
  void measure(const octomap::OcTreeKey& key, bool is_hit);

  double shadow_length_;
};

}  // namespace skycap::tests
