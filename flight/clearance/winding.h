/// Winding number of a triangle mesh: an inside test that is robust against holes, duplicate
/// surfaces and wrong orientation.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "flight/clearance/bounding_tree.h"

namespace skycap::flight {

/// Generalised winding number (Jacobson et al. 2013, Eq. (5)) of the triangles in a tree: 1 inside
/// a closed surface, 0 outside. Distant nodes are approximated by one dipole (Barill et al. 2018,
/// first order). The orientation of an inward-facing closed surface is reversed. An open surface is
/// assumed to face outward, because the hollow side of a sheet (a valley) must not count as inside.
class WindingNumber {
 public:
  WindingNumber() = default;
  WindingNumber(const BoundingTree& tree, const std::vector<Triangle>& triangles);

  double at(const BoundingTree& tree, const std::vector<Triangle>& triangles,
            const Eigen::Vector3d& point) const;

 private:
  struct Dipole {
    Eigen::Vector3d area_vector = Eigen::Vector3d::Zero();
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< Area-weighted centroid.
    double area = 0.0;
    /// Squared radius around the centre that contains the node's box [m^2].
    double squared_reach = 0.0;
  };

  Dipole gather(const BoundingTree& tree, const std::vector<Triangle>& triangles,
                std::uint32_t node);
  double sum(const BoundingTree& tree, const std::vector<Triangle>& triangles,
             const Eigen::Vector3d& point, std::uint32_t node) const;

  std::vector<Dipole> dipoles_;  ///< One dipole per tree node.
  double orientation_ = 1.0;     ///< -1 for a closed mesh that faces inward.
};

}  // namespace skycap::flight
