#include "missions/judge/accuracy.h"

#include <algorithm>
#include <cmath>

namespace skycap::missions::judge {

void AccuracyMeter::add(std::span<const Eigen::Vector3f> points) {
  piece_.resize(points.size());
  distance_.distances(points, piece_, threads_);
  // In the order of the points, so that the sums depend neither on pieces nor on threads.
  for (const double distance : piece_) {
    sum_ += distance;
    squares_ += distance * distance;
    kept_.push_back(static_cast<float>(distance));
  }
}

double AccuracyMeter::share_within(double distance) const {
  if (kept_.empty()) return 0.0;
  const auto within = std::ranges::count_if(kept_, [&](float d) { return d <= distance; });
  return static_cast<double>(within) / static_cast<double>(kept_.size());
}

CloudAccuracy AccuracyMeter::accuracy() {
  if (kept_.empty()) return {};
  const auto count = static_cast<double>(kept_.size());
  const auto quantile = [&](double share) -> double {
    const auto place = kept_.begin() + static_cast<std::ptrdiff_t>(share * (count - 1.0));
    std::ranges::nth_element(kept_, place);
    return *place;
  };
  return {sum_ / count, std::sqrt(squares_ / count), quantile(0.5), quantile(0.95),
          *std::ranges::max_element(kept_)};
}

}  // namespace skycap::missions::judge
