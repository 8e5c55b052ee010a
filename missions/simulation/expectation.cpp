#include "missions/simulation/expectation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "flight/motion/motion.h"
#include "geometry/surfaces/mesh.h"
#include "missions/evaluation/coverage.h"
#include "missions/evaluation/downsampled_cloud.h"
#include "missions/session/initial_pattern_flight.h"
#include "missions/simulation/omniscient.h"
#include "sim/sensors/survey_sensor.h"
#include "survey/planners/planner_names.h"
#include "survey/planners/planner_options.h"

namespace skycap::missions::simulation {
namespace {

using geometry::View;

constexpr OmniscientConfig few{.candidates = 400, .samples = 2000, .target_coverage = {}};

// Bytes of the whole program, from the peak memory of surveys of the shipped missions.
constexpr double base_bytes = 5e7;
constexpr double a_triangle = 150.0;
constexpr double a_pixel = 50.0;
constexpr double a_point = 60.0;
constexpr double seconds_per_minute = 60.0;
constexpr double packing = 0.7;  // Stored points per square of their spacing.

/// Ratio between the numbers of views of a planner and of the oracle in the surveys of docs/.
struct Share {
  double min, max;
};

Share find_view_ratio(survey::PlannerName planner) {
  switch (planner) {
    case survey::PlannerName::skycap:
      return {1.1, 2.0};
    case survey::PlannerName::see_plus_plus:
      return {1.3, 4.0};
    default:
      return {6.0, 9.0};
  }
}

double path_from_json(const std::vector<View>& views) {
  double distance = 0.0;
  for (std::size_t i = 1; i < views.size(); ++i) {
    distance += (views[i].position - views[i - 1].position).norm();
  }
  return distance;
}

/// Returns the time from take-off to the first view, through the initial pattern, and from the last
/// view to landing [s].
double estimate_transfer(const session::SurveyOptions& options, const std::vector<View>& known,
                         const flight::Motion& motion, std::uint64_t seed) {
  const flight::FlightOptions& flight = options.flight;
  const double height = known.front().position.z();
  const Eigen::Vector3d pad = flight.takeoff.value_or(
      Eigen::Vector3d(known.front().position.x(), known.front().position.y(), 0.0));
  const double climb = std::max(flight.route(pad).takeoff_climb, height - pad.z());
  const Eigen::Vector3d home(pad.x(), pad.y(), pad.z() + climb);
  const double time = motion.takeoff_time(climb) + motion.landing_time(climb) +
                      motion.leg_time(known.front().position - home) +
                      motion.leg_time(home - known.back().position);
  const std::vector<View> pattern = session::initial_pattern_views(options.start, seed);
  return time + path_from_json(pattern) / flight.cruise_speed;
}

/// Returns the flight time for a number of views [min]. The path length grows with the square root
/// of this number, as for tours.
double estimate_minutes(const session::SurveyOptions& options, const std::vector<View>& known,
                        double views, std::uint64_t seed) {
  const double more = std::sqrt(views / static_cast<double>(known.size()));
  const double distance = path_from_json(known) * more;
  const flight::FlightOptions& flight = options.flight;
  if (!flight.has_vehicle()) {
    return (distance / options.limits.speed + views * options.limits.time_per_view) /
           seconds_per_minute;
  }
  const flight::Motion motion(flight.required_vehicle(),
                              flight.route(Eigen::Vector3d::Zero()).conditions);
  const double stop = flight.rest_before() + flight.rest_after();
  const double leg = motion.leg_time({distance / views, 0.0, 0.0});
  return (estimate_transfer(options, known, motion, seed) + views * (leg + stop)) /
         seconds_per_minute;
}

double estimate_memory(const survey::PlannerOptions& planner, const evaluation::SurveyScene& scene,
                       double views) {
  const auto pixels = static_cast<double>(planner.camera.width) * planner.camera.height;
  const double spacing = planner.spacing;
  const double area = geometry::surface_area(scene.model());
  const double points = std::min(packing * area / (spacing * spacing), views * pixels);
  return base_bytes + a_triangle * static_cast<double>(scene.model().triangles.size()) +
         a_pixel * pixels + a_point * points;
}

/// Seconds of parts of a survey's first view.
struct ViewTimes {
  double measured = 0.0;   ///< the scan
  double planned = 0.0;    ///< the next view
  double evaluated = 0.0;  ///< which surface the scan covers
};

double seconds_since(std::chrono::steady_clock::time_point begun) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

ViewTimes times_of_a_view(const evaluation::SimulationOptions& options,
                          const evaluation::SurveyScene& scene, const session::RunOptions& run) {
  const auto planner = survey::make_planner(
      options.survey.planner, {.seed = run.seed,
                               .threads = run.threads,
                               .sphere = scene.view_sphere(),
                               .true_scene_admits = scene.admissible().allows,
                               .pattern_target = scene.pattern_target(options.survey.planner)});
  const sim::SurveySensor sensor(options.sensor, run.seed);
  ViewTimes times;
  const auto begun = std::chrono::steady_clock::now();
  const geometry::Scan scan =
      sensor.scan(scene.scene(), scene.first_view(run.seed), 0, run.threads);
  times.measured = seconds_since(begun);
  planner->next_view(scan);
  times.planned = seconds_since(begun) - times.measured;
  evaluation::CoverageMeter meter(scene.samples().points, options.evaluation.registration_distance);
  evaluation::DownsampledCloud cloud(options.survey.planner.spacing);
  const auto kept = std::chrono::steady_clock::now();
  meter.add(cloud.store(scan.points, options.scene_box()));
  times.evaluated = seconds_since(kept);
  return times;
}

/// Returns the number of views of fixed sets and patterns, or nullopt for planners.
std::optional<std::size_t> count_fixed_views(const survey::PlannerOptions& planner,
                                             const evaluation::SurveyScene& scene) {
  if (const auto* set = std::get_if<survey::fixed_views::FixedViewsConfig>(&planner.method)) {
    return set->settings.views;
  }
  const auto* given = std::get_if<survey::patterns::PatternConfig>(&planner.method);
  if (given == nullptr) return std::nullopt;
  survey::patterns::PatternConfig pattern = *given;
  if (!pattern.target) pattern.target = scene.pattern_target(planner);
  return survey::patterns::plan_pattern(pattern).views.size();
}

}  // namespace

Expectation expectation(const evaluation::SimulationOptions& options,
                        const evaluation::SurveyScene& scene, const session::RunOptions& run) {
  const session::SurveyOptions& asked = options.survey;
  const std::vector<View> known = known_cover(options, scene, run.seed, run.threads, few);
  double limit = static_cast<double>(asked.limits.max_views);
  const std::optional<std::size_t> fixed = count_fixed_views(asked.planner, scene);
  if (fixed) limit = std::min(limit, static_cast<double>(*fixed));
  const auto count = static_cast<double>(known.size());
  const bool has_view_limit = survey::find_title(asked.planner.name).metric.has_value() || fixed ||
                              survey::is_pb_nbv(asked.planner.name);
  const Share share = find_view_ratio(asked.planner.name);
  const double min = has_view_limit ? limit : std::min(limit, std::round(share.min * count));
  const double max = has_view_limit ? limit : std::min(limit, std::round(share.max * count));
  const double minutes =
      asked.limits.max_time.value_or(std::numeric_limits<double>::max()) / seconds_per_minute;
  const ViewTimes times = times_of_a_view(options, scene, run);
  const double view = times.measured + times.planned + times.evaluated;
  // The written files are flown again; if they capture different views, several times.
  const double again = times.measured + 2.0 * times.evaluated;
  // Route, return and files of a small survey [s].
  constexpr double min_results = 0.3, max_results = 1.5;
  // The attainable coverage takes scans that nothing is planned from, fewer if they cover it all.
  constexpr double fewest = 0.5;
  const double attainable =
      (times.measured + times.evaluated) * static_cast<double>(options.evaluation.attainable_views);
  return {.known_views = known.size(),
          .min_views = static_cast<std::size_t>(min),
          .max_views = static_cast<std::size_t>(max),
          .min_minutes = std::min(minutes, estimate_minutes(asked, known, min, run.seed)),
          .max_minutes = std::min(minutes, estimate_minutes(asked, known, max, run.seed)),
          .memory = estimate_memory(asked.planner, scene, max),
          .min_time = min_results + (view + again) * min + fewest * attainable,
          .max_time = max_results + (view + 2.0 * again) * max + attainable};
}

}  // namespace skycap::missions::simulation
