#include "missions/evaluation/cloud_judge.h"

#include "geometry/parallel.h"

namespace skycap::missions::evaluation {

std::vector<Eigen::Vector3f> places_asked(const geometry::Mesh& truth, std::size_t count) {
  constexpr std::uint64_t seed = 1;
  return geometry::sample_surface(truth, count, seed).points;
}

CloudJudge::CloudJudge(const geometry::Mesh& truth, std::size_t places,
                       double registration_distance, unsigned threads, const geometry::Mesh& beside)
    : area_(geometry::surface_area(truth)),
      threads_(threads),
      coverage_(places_asked(truth, places), registration_distance),
      accuracy_(truth, threads, beside) {}

void CloudJudge::add(std::span<const Eigen::Vector3f> points) {
  geometry::parallel_for(2, threads_, [&](std::size_t part) {
    if (part == 0) {
      coverage_.add(points);
    } else {
      accuracy_.add(points);
    }
  });
}

CloudJudgement CloudJudge::judgement() {
  CloudTally tally = take_tally();
  return judgement_of(tally, area_);
}

void CloudTally::add(const CloudTally& more) {
  distances.add(more.distances);
  if (is_covered.empty()) is_covered.resize(more.is_covered.size());
  for (std::size_t i = 0; i < is_covered.size(); ++i) is_covered[i] |= more.is_covered[i];
}

CloudJudgement judgement_of(CloudTally& tally, double area) {
  return {tally.distances.distances.size(),
          tally.distances.beside,
          marked_share(tally.is_covered),
          tally.distances.accuracy(),
          area,
          tally.is_covered};
}

}  // namespace skycap::missions::evaluation
