#include "missions/batch/benchmark/benchmark_results.h"

#include <algorithm>
#include <cmath>

namespace skycap::missions::batch {
namespace {

template <typename Figure>
Statistic over(const std::vector<Trial>& trials, Figure figure) {
  std::vector<double> numbers;
  numbers.reserve(trials.size());
  for (const Trial& trial : trials) numbers.push_back(figure(trial));
  return statistic(numbers);
}

double ratio(double a, std::size_t b) { return b > 0 ? a / static_cast<double>(b) : 0.0; }

/// Returns a trial's position on the axis after a view.
double curve_position(const Trial& trial, CurveAxis axis, std::size_t view) {
  switch (axis) {
    case CurveAxis::views:
      return static_cast<double>(view + 1);
    case CurveAxis::planning_time:
      return trial.planning_time_after[view];
    case CurveAxis::flight_time:
      return trial.flight_time_after[view];
    case CurveAxis::distance:
      break;
  }
  return trial.distance_after[view];
}

/// Returns a trial's coverage at `x`, after the last view up to this position.
double coverage_at(const Trial& trial, CurveAxis axis, double x) {
  double coverage = 0.0;
  for (std::size_t view = 0; view < trial.coverage_after.size(); ++view) {
    if (curve_position(trial, axis, view) > x) break;
    coverage = trial.coverage_after[view];
  }
  return coverage;
}

/// Returns the sampling positions of the curve, up to the end of the longest trial.
std::vector<double> positions(const std::vector<Trial>& trials, CurveAxis axis, std::size_t count) {
  double first = INFINITY, last = 0.0;
  for (const Trial& trial : trials) {
    if (trial.coverage_after.empty()) continue;
    first = std::min(first, curve_position(trial, axis, 0));
    last = std::max(last, curve_position(trial, axis, trial.coverage_after.size() - 1));
  }
  std::vector<double> xs;
  if (!std::isfinite(first)) return xs;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = ratio(static_cast<double>(i), count - 1);
    const bool by_factors = axis == CurveAxis::planning_time && first > 0.0;
    xs.push_back(i + 1 == count ? last
                 : by_factors   ? first * std::pow(last / first, share)
                                : first + share * (last - first));
  }
  return xs;
}

}  // namespace

CellFigures compute_figures(const BenchmarkCell& cell) {
  const std::vector<Trial>& trials = cell.trials;
  CellFigures figures{
      .views = over(trials, [](const Trial& t) { return static_cast<double>(t.views); }),
      .coverage = over(trials, [](const Trial& t) { return t.coverage.all; }),
      .coverage_visible = {},
      .attainable_coverage = trials.front().coverage.attainable_coverage,
      .planning_time = over(trials, [](const Trial& t) { return t.planning_time; }),
      .distance = over(trials, [](const Trial& t) { return t.distance; })};
  const auto has_visible = [](const Trial& t) { return t.coverage.visible.has_value(); };
  if (std::ranges::all_of(trials, has_visible)) {
    figures.coverage_visible = over(trials, [](const Trial& t) { return *t.coverage.visible; });
  }
  if (std::ranges::all_of(trials, &Trial::has_vehicle)) {
    figures.flight_time = over(trials, [](const Trial& t) { return *t.flight_time(); });
  }
  return figures;
}

ViewFigures view_figures(const std::vector<Trial>& trials) {
  return {over(trials,
               [](const Trial& t) {
                 return ratio(static_cast<double>(t.frontiers_resolved), t.views);
               }),
          over(trials, [](const Trial& t) { return ratio(t.coverage.all, t.views); })};
}

std::optional<ReachFigures> reach_figures(const std::vector<Trial>& trials, double coverage) {
  std::vector<double> views, distances, times;
  for (const Trial& trial : trials) {
    const auto there = std::ranges::find_if(trial.coverage_after,
                                            [&](double reached) { return reached >= coverage; });
    if (there == trial.coverage_after.end()) continue;
    const auto view = static_cast<std::size_t>(there - trial.coverage_after.begin());
    views.push_back(static_cast<double>(view + 1));
    distances.push_back(trial.distance_after[view]);
    times.push_back(trial.planning_time_after[view]);
  }
  if (views.empty()) return std::nullopt;
  return ReachFigures{views.size(), statistic(views), statistic(distances), statistic(times)};
}

std::vector<CurvePoint> coverage_curve(const std::vector<Trial>& trials, CurveAxis axis,
                                       std::size_t count) {
  std::vector<CurvePoint> curve;
  const bool is_time_axis = axis == CurveAxis::flight_time;
  if (is_time_axis && !std::ranges::all_of(trials, &Trial::has_vehicle)) return curve;
  for (const double x : positions(trials, axis, count)) {
    const Statistic coverage =
        over(trials, [&](const Trial& trial) { return coverage_at(trial, axis, x); });
    curve.push_back({x, coverage.mean, coverage.deviation});
  }
  return curve;
}

TargetFigures target_figures(const std::vector<Trial>& trials) {
  TargetFigures figures;
  figures.share_by_views.assign(target_view_bins, 0.0);
  figures.share_by_distance.assign(target_distance_bins, 0.0);
  for (const Trial& trial : trials) {
    for (const ObservedTarget& target : trial.targets) {
      ++figures.targets;
      figures.share_by_views[std::min(target.views, target_view_bins) - 1] += 1.0;
      for (std::size_t bin = 0; bin < target_distance_bins; ++bin) {
        const double limit = target_distance_bin * static_cast<double>(bin + 1);
        if (target.distance < limit) figures.share_by_distance[bin] += 1.0;
      }
    }
  }
  for (double& share : figures.share_by_views) share = ratio(share, figures.targets);
  for (double& share : figures.share_by_distance) share = ratio(share, figures.targets);
  return figures;
}

}  // namespace skycap::missions::batch
