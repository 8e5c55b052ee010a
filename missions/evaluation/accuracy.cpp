#include "missions/evaluation/accuracy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skycap::missions::evaluation {

AccuracyMeter::AccuracyMeter(const geometry::Mesh& truth, unsigned threads,
                             const geometry::Mesh& surroundings)
    : distance_(truth, threads), threads_(threads) {
  if (!surroundings.triangles.empty()) surroundings_.emplace(surroundings, threads);
}

void AccuracyMeter::add(std::span<const Eigen::Vector3f> points) {
  distances_.resize(points.size());
  distance_.distances(points, distances_, threads_);
  surroundings_distances_.assign(points.size(), std::numeric_limits<double>::infinity());
  if (surroundings_) surroundings_->distances(points, surroundings_distances_, threads_);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = distances_[i];
    if (surroundings_distances_[i] < distance) {
      ++tally_.surroundings;
      continue;
    }
    tally_.sum.add(distance);
    tally_.squares.add(distance * distance);
    tally_.distances.push_back(static_cast<float>(distance));
  }
}

double AccuracyMeter::share_within(double distance) const {
  const std::vector<float>& kept = tally_.distances;
  if (kept.empty()) return 0.0;
  const auto within = std::ranges::count_if(kept, [&](float d) { return d <= distance; });
  return static_cast<double>(within) / static_cast<double>(kept.size());
}

void DistanceTally::add(const DistanceTally& more) {
  sum.add(more.sum);
  squares.add(more.squares);
  distances.insert(distances.end(), more.distances.begin(), more.distances.end());
  surroundings += more.surroundings;
}

CloudAccuracy DistanceTally::accuracy() {
  if (distances.empty()) return {};
  const auto count = static_cast<double>(distances.size());
  const auto quantile = [&](double share) -> double {
    const auto rank = distances.begin() + static_cast<std::ptrdiff_t>(share * (count - 1.0));
    std::ranges::nth_element(distances, rank);
    return *rank;
  };
  return {sum.value() / count, std::sqrt(squares.value() / count), quantile(0.5), quantile(0.95),
          *std::ranges::max_element(distances)};
}

}  // namespace skycap::missions::evaluation
