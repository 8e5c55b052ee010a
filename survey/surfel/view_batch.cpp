#include "survey/surfel/view_batch.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace skycap::survey::surfel {

using Eigen::Vector3d;

std::vector<Stop> pick_batch(std::span<const BatchView> views, std::vector<float> weights,
                             const Vector3d& position, const BatchSettings& settings) {
  std::vector<double> path_length(views.size());
  for (std::size_t i = 0; i < views.size(); ++i)
    path_length[i] = (views[i].position - position).norm();

  std::vector<Stop> batch;
  while (batch.size() < settings.size) {
    std::size_t best = 0;
    double best_score = 0.0, best_gain = 0.0;
    for (std::size_t i = 0; i < views.size(); ++i) {
      double gain = 0.0;
      for (const VisibleTarget& s : views[i].visible_targets)
        gain += weights[s.target] * s.covered_share;
      const double value = gain / (settings.view_price + path_length[i]);
      if (value > best_score) {
        best = i;
        best_score = value;
        best_gain = gain;
      }
    }
    if (!(best_score > 0.0)) break;
    if (!batch.empty() && best_gain < settings.min_fraction * batch.front().gain) break;
    batch.push_back({best, best_gain});
    for (const VisibleTarget& s : views[best].visible_targets)
      weights[s.target] *= 1.0F - s.covered_share;
    for (std::size_t i = 0; i < views.size(); ++i) {
      path_length[i] = std::min(path_length[i], (views[i].position - views[best].position).norm());
    }
  }
  return batch;
}

std::size_t first_stop(std::span<const BatchView> views, std::span<const Stop> batch,
                       const Vector3d& position, double impatience) {
  std::vector<std::size_t> order(batch.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  double total_gain = 0.0;
  for (const Stop& stop : batch) total_gain += stop.gain;
  std::size_t best_first = 0;
  double best_cost = std::numeric_limits<double>::infinity();
  do {
    Vector3d at = position;
    double length = 0.0, waited = 0.0;
    for (const std::size_t i : order) {
      const Vector3d& next = views[batch[i].view].position;
      length += (next - at).norm();
      waited += length * batch[i].gain / total_gain;
      at = next;
    }
    const double cost = length + impatience * waited;
    if (cost < best_cost) {
      best_cost = cost;
      best_first = order.front();
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best_first;
}

}  // namespace skycap::survey::surfel
