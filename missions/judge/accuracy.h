/// How accurate a cloud is: the distances of its points from the true surface.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"
#include "geometry/surfaces/mesh_distance.h"

namespace skycap::missions::judge {

/// Distances of measured points from the true surface [m]. All zero of no points.
struct CloudAccuracy {
  double mean = 0.0;
  double root_mean_square = 0.0;
  double median = 0.0;
  double percentile_95 = 0.0;
  double largest = 0.0;
};

/// Measures them while points come in, in any pieces: four bytes are kept of each point, whose
/// precision median, percentile and largest have.
class AccuracyMeter {
 public:
  explicit AccuracyMeter(const geometry::Mesh& truth, unsigned threads = 0)
      : distance_(truth), threads_(threads) {}

  void add(std::span<const Eigen::Vector3f> points);

  std::size_t points() const { return kept_.size(); }

  /// The share of the points so far that are no farther than that from the surface.
  double share_within(double distance) const;

  /// Of all points so far; sorts what is kept.
  CloudAccuracy accuracy();

 private:
  geometry::MeshDistance distance_;
  unsigned threads_;
  double sum_ = 0.0, squares_ = 0.0;
  std::vector<double> piece_;  ///< memory for the distances of what is added
  std::vector<float> kept_;
};

}  // namespace skycap::missions::judge
