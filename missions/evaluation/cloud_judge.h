/// A cloud against the true surface: how much of it is covered, and how far off the points are.
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

struct CloudJudgement {
  std::size_t points = 0;    ///< of the surface
  std::uint64_t beside = 0;  ///< points of what stands beside it
  double coverage = 0.0;     ///< share of the surface, in [0, 1]
  CloudAccuracy accuracy;
  double area = 0.0;  ///< of the surface [m^2]
  /// For each of the places asked, 1 if it is covered; empty where that was not kept.
  std::vector<std::uint8_t> is_covered{};

  /// Points for each square metre of the surface.
  double density() const { return static_cast<double>(points) / area; }
};

/// What judging is made of: parts of a cloud, judged by whoever, add up to all of it.
struct CloudTally {
  DistanceTally distances;
  std::vector<std::uint8_t> is_covered;  ///< of each of the places asked; of equally many

  void add(const CloudTally& more);
};

/// Of a surface of that area. Sorts the distances.
CloudJudgement judgement_of(CloudTally& tally, double area);

/// `count` places of a surface that stand for it, the same ones each time.
std::vector<Eigen::Vector3f> places_asked(const geometry::Mesh& truth, std::size_t count);

/// Takes in a cloud of any length, in any pieces.
class CloudJudge {
 public:
  /// `places` of the surface are covered by points within `registration_distance` of them. What is
  /// `beside` it counts as AccuracyMeter says.
  CloudJudge(const geometry::Mesh& truth, std::size_t places, double registration_distance,
             unsigned threads = 0, const geometry::Mesh& beside = {});

  void add(std::span<const Eigen::Vector3f> points);

  /// Of all points so far, of which it keeps no distances.
  CloudTally take_tally() { return {accuracy_.take_tally(), coverage_.is_covered()}; }
  CloudJudgement judgement();  ///< of take_tally()

 private:
  double area_;
  unsigned threads_;
  CoverageMeter coverage_;
  AccuracyMeter accuracy_;
};

}  // namespace skycap::missions::evaluation
