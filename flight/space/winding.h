/// How often a triangle mesh winds around a point: the inside test that survives holes, doubled
/// surfaces and wrong orientation.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "flight/space/bounding_tree.h"

namespace skycap::flight {

/// Generalised winding number (Jacobson et al. 2013, Eq. (5)) of the triangles under a tree: 1
/// inside a closed surface, 0 outside. Nodes that are far for their size count as one dipole
/// (Barill et al. 2018, first order). A closed surface that faces inward is turned round; an open
/// one is taken to face outward, for the hollow side of a sheet (a valley) must not count as
/// inside.
class WindingNumber {
 public:
  WindingNumber() = default;
  WindingNumber(const BoundingTree& tree, const std::vector<Triangle>& triangles);

  double at(const BoundingTree& tree, const std::vector<Triangle>& triangles,
            const Eigen::Vector3d& point) const;

 private:
  struct Dipole {
    Eigen::Vector3d area_vector = Eigen::Vector3d::Zero();
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< weighted by area
    double area = 0.0;
    double squared_reach = 0.0;  ///< squared radius around the centre that holds the node's box
  };

  Dipole gather(const BoundingTree& tree, const std::vector<Triangle>& triangles,
                std::uint32_t node);
  double sum(const BoundingTree& tree, const std::vector<Triangle>& triangles,
             const Eigen::Vector3d& point, std::uint32_t node) const;

  std::vector<Dipole> dipoles_;  ///< one for each node of the tree
  double orientation_ = 1.0;     ///< -1 for a closed mesh that faces inward
};

}  // namespace skycap::flight
