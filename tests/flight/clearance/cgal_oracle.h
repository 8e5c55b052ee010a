/// An independent judge of a leg's clearance: bisection on CGAL's point distances. It shares
/// neither the tree nor the distance formulas with the product.
///
/// Distance to a closed set is 1-Lipschitz, so over a piece of length L whose ends are at distances
/// d0 and d1 it is at least (d0 + d1 - L) / 2, and an end nearer than the clearance is a witness.
#pragma once

#include <memory>

#include "flight/clearance/segment_distance.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight {

enum class Verdict { clear, violated, grazing };

class CgalOracle {
 public:
  explicit CgalOracle(const geometry::Mesh& mesh);
  ~CgalOracle();

  double distance(const Eigen::Vector3d& point) const;

  /// `grazing`: undecided when the pieces are shorter than 10 nm.
  Verdict classify(const Segment& leg, double clearance) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::flight
