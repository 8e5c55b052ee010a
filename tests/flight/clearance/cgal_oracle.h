/// Independent check of a leg's clearance: bisection on CGAL point distances. It shares neither the
/// tree nor the distance formulas with the product.
///
/// The distance to a closed set is 1-Lipschitz. On a piece of length L with end distances d0 and d1
/// it is therefore at least (d0 + d1 - L) / 2. An end point closer than the clearance is a
/// counterexample.
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

  /// Returns `grazing` if pieces shorter than 10 nm are still undecided.
  Verdict classify(const Segment& leg, double clearance) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::flight
