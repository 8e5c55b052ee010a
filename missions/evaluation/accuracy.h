/// Accuracy of a point cloud: distances of its points from the ground-truth surface.
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

/// Statistics of point distances from the ground-truth surface [m]. All are zero for an empty
/// cloud.
struct CloudAccuracy {
  double mean = 0.0;
  double root_mean_square = 0.0;
  double median = 0.0;
  double percentile_95 = 0.0;
  double largest = 0.0;
};

/// Partial result of distance statistics. Tallies of different parts of a cloud can be merged in
/// any order without changing the result. Distances are stored in single precision, which limits
/// the precision of median, percentile and maximum.
struct DistanceTally {
  ExactSum sum, squares;
  std::vector<float> distances;
  std::uint64_t surroundings = 0;  ///< points on adjacent objects, not on the surface

  void add(const DistanceTally& more);
  /// Computes the statistics. Sorts the stored distances.
  CloudAccuracy accuracy();
};

/// Computes distance statistics incrementally. Points closer to the mesh `surroundings` (such as
/// ground) than to the surface are attributed to it and excluded from the statistics.
class AccuracyMeter {
 public:
  explicit AccuracyMeter(const geometry::Mesh& truth, unsigned threads = 0,
                         const geometry::Mesh& surroundings = {});

  void add(std::span<const Eigen::Vector3f> points);

  std::size_t points() const { return tally_.distances.size(); }  ///< points on the surface
  std::uint64_t surroundings() const { return tally_.surroundings; }
  /// Returns the tally and resets it.
  DistanceTally take_tally() { return std::exchange(tally_, {}); }

  /// Returns the fraction of points so far within `distance` of the surface [m].
  double share_within(double distance) const;

  /// Returns the statistics of all points so far. Sorts the stored distances.
  CloudAccuracy accuracy() { return tally_.accuracy(); }

 private:
  geometry::MeshDistance distance_;
  std::optional<geometry::MeshDistance> surroundings_;
  unsigned threads_;
  std::vector<double> distances_,
      surroundings_distances_;  ///< reused buffers for the distances of added points
  DistanceTally tally_;
};

}  // namespace skycap::missions::evaluation
