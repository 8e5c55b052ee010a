#include "missions/batch/benchmark/trial_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "missions/batch/benchmark/benchmark_results.h"

namespace skycap::missions::batch {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t curve_points = 100;

Json curve_json(const std::vector<Trial>& trials, CurveAxis axis) {
  Json x = Json::array(), mean = Json::array(), deviation = Json::array();
  for (const CurvePoint& point : coverage_curve(trials, axis, curve_points)) {
    x.push_back(point.x);
    mean.push_back(point.mean);
    deviation.push_back(point.deviation);
  }
  return {{"x", x}, {"coverage", mean}, {"standard_deviation", deviation}};
}

}  // namespace

Json statistic_json(const Statistic& statistic) {
  // JSON has no infinity: one trial says nothing about the mean's certainty.
  return {{"mean", statistic.mean},
          {"standard_deviation", statistic.deviation},
          {"half_width_95",
           std::isfinite(statistic.half_width_95) ? Json(statistic.half_width_95) : Json()}};
}

Json curves_json(const std::vector<Trial>& trials) {
  return {{"views", curve_json(trials, CurveAxis::views)},
          {"planning_time_s", curve_json(trials, CurveAxis::planning_time)},
          {"distance_m", curve_json(trials, CurveAxis::distance)},
          {"flown_s", curve_json(trials, CurveAxis::flown_time)}};
}

Json each_trial_json(const std::vector<Trial>& trials) {
  Json list = Json::array();
  for (const Trial& trial : trials) {
    list.push_back({{"seed", trial.seed},
                    {"stop_reason", session::name_of(trial.stop_reason)},
                    {"views", trial.views},
                    {"coverage", trial.coverage.all},
                    {"distance_m", trial.distance},
                    {"flown_s", trial.is_flown() ? Json(*trial.flown_time()) : Json()},
                    {"planning_time_s", trial.planning_time}});
  }
  return list;
}

}  // namespace skycap::missions::batch
