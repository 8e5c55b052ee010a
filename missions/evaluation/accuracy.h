/// How accurate a cloud is: the distances of its points from the true surface.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/evaluation/exact_sum.h"

namespace skycap::missions::evaluation {

/// Distances of measured points from the true surface [m]. All zero of no points.
struct CloudAccuracy {
  double mean = 0.0;
  double root_mean_square = 0.0;
  double median = 0.0;
  double percentile_95 = 0.0;
  double largest = 0.0;
};

/// What is kept of distances, from which all figures follow, whoever has measured which of them:
/// four bytes of each, whose precision median, percentile and largest have.
struct DistanceTally {
  ExactSum sum, squares;
  std::vector<float> distances;
  std::uint64_t beside = 0;  ///< points of what stands beside the surface

  void add(const DistanceTally& more);
  /// Sorts the distances.
  CloudAccuracy accuracy();
};

/// Measures them while points come in, in any pieces. Points that are nearer to what stands
/// `beside` the surface, such as ground, are of that, and have no part in the figures.
class AccuracyMeter {
 public:
  explicit AccuracyMeter(const geometry::Mesh& truth, unsigned threads = 0,
                         const geometry::Mesh& beside = {});

  void add(std::span<const Eigen::Vector3f> points);

  std::size_t points() const { return tally_.distances.size(); }  ///< of the surface
  std::uint64_t beside() const { return tally_.beside; }
  /// Leaves nothing.
  DistanceTally take_tally() { return std::exchange(tally_, {}); }

  /// The share of the points so far that are no farther than that from the surface.
  double share_within(double distance) const;

  /// Of all points so far; sorts what is kept.
  CloudAccuracy accuracy() { return tally_.accuracy(); }

 private:
  geometry::MeshDistance distance_;
  std::optional<geometry::MeshDistance> beside_;
  unsigned threads_;
  std::vector<double> piece_, piece_beside_;  ///< memory for the distances of what is added
  DistanceTally tally_;
};

}  // namespace skycap::missions::evaluation
