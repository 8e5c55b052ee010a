#include "missions/evaluation/cloud_evaluator.h"

#include "geometry/parallel.h"

namespace skycap::missions::evaluation {

std::vector<Eigen::Vector3f> sample_positions(const geometry::Mesh& truth, std::size_t count) {
  constexpr std::uint64_t seed = 1;
  return geometry::sample_surface(truth, count, seed).points;
}

CloudEvaluator::CloudEvaluator(const geometry::Mesh& truth, std::size_t sample_count,
                               double registration_distance, unsigned threads,
                               const geometry::Mesh& surroundings)
    : area_(geometry::surface_area(truth)),
      threads_(threads),
      coverage_(sample_positions(truth, sample_count), registration_distance),
      accuracy_(truth, threads, surroundings) {}

void CloudEvaluator::add(std::span<const Eigen::Vector3f> points) {
  geometry::parallel_for(2, threads_, [&](std::size_t part) {
    if (part == 0) {
      coverage_.add(points);
    } else {
      accuracy_.add(points);
    }
  });
}

CloudEvaluation CloudEvaluator::result() {
  CloudTally tally = take_tally();
  return evaluate_tally(tally, area_);
}

void CloudTally::add(const CloudTally& more) {
  distances.add(more.distances);
  if (is_covered.empty()) is_covered.resize(more.is_covered.size());
  for (std::size_t i = 0; i < is_covered.size(); ++i) is_covered[i] |= more.is_covered[i];
}

CloudEvaluation evaluate_tally(CloudTally& tally, double area) {
  return {tally.distances.distances.size(),
          tally.distances.surroundings,
          marked_share(tally.is_covered),
          tally.distances.accuracy(),
          area,
          tally.is_covered};
}

}  // namespace skycap::missions::evaluation
