/// Evaluation of a cloud against the ground-truth surface: coverage and accuracy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"
#include "missions/evaluation/accuracy.h"
#include "missions/evaluation/coverage.h"

namespace skycap::missions::evaluation {

struct CloudEvaluation {
  std::size_t points = 0;          ///< points on the surface
  std::uint64_t surroundings = 0;  ///< points on adjacent objects
  double coverage = 0.0;           ///< covered fraction of the surface, in [0, 1]
  CloudAccuracy accuracy;
  double area = 0.0;  ///< surface area [m^2]
  /// For each surface sample, 1 if it is covered and 0 otherwise. Empty if not recorded.
  std::vector<std::uint8_t> is_covered{};

  /// Returns the number of points per square metre of surface.
  double density() const { return static_cast<double>(points) / area; }
};

/// Partial result of an evaluation. Tallies of parts of a cloud add up to that of the whole cloud.
struct CloudTally {
  DistanceTally distances;
  /// For each surface sample, 1 if covered; sizes must match in add().
  std::vector<std::uint8_t> is_covered;

  void add(const CloudTally& more);
};

/// Computes the evaluation for a surface of `area` [m^2]. Sorts the distances in `tally`.
CloudEvaluation evaluate_tally(CloudTally& tally, double area);

/// Returns `count` deterministic, evenly distributed samples of a surface.
std::vector<Eigen::Vector3f> sample_positions(const geometry::Mesh& truth, std::size_t count);

/// Evaluates a cloud that is added in pieces of any size.
class CloudEvaluator {
 public:
  /// Prepares `sample_count` surface samples. A sample is covered if a point is within
  /// `registration_distance` of it [m]. Points on `surroundings` are handled as in AccuracyMeter.
  CloudEvaluator(const geometry::Mesh& truth, std::size_t sample_count,
                 double registration_distance, unsigned threads = 0,
                 const geometry::Mesh& surroundings = {});

  void add(std::span<const Eigen::Vector3f> points);

  /// Returns the tally of all points so far and clears the stored distances.
  CloudTally take_tally() { return {accuracy_.take_tally(), coverage_.is_covered()}; }
  CloudEvaluation result();  ///< evaluates take_tally()

 private:
  double area_;
  unsigned threads_;
  CoverageMeter coverage_;
  AccuracyMeter accuracy_;
};

}  // namespace skycap::missions::evaluation
