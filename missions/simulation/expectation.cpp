#include "missions/simulation/expectation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "flight/motion/motion.h"
#include "geometry/surfaces/mesh.h"
#include "missions/session/initial_pattern_flight.h"
#include "missions/simulation/omniscient.h"
#include "missions/simulation/planning_time.h"
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
      return {0.8, 2.5};
    case survey::PlannerName::see_plus_plus:
      return {1.3, 4.0};
    default:
      return {6.0, 9.0};
  }
}

double path_length(const std::vector<View>& views) {
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
  return time + path_length(pattern) / flight.cruise_speed;
}

/// Returns the flight time for a number of views [min]. The path length grows with the square root
/// of this number, as for tours.
double estimate_minutes(const session::SurveyOptions& options, const std::vector<View>& known,
                        double views, std::uint64_t seed) {
  const double more = std::sqrt(views / static_cast<double>(known.size()));
  const double distance = path_length(known) * more;
  const flight::FlightOptions& flight = options.flight;
  if (!flight.has_vehicle()) {
    return (distance / options.limits.speed + views * options.limits.time_per_view) /
           seconds_per_minute;
  }
  const flight::Motion motion(flight.required_vehicle(),
                              flight.route(Eigen::Vector3d::Zero()).conditions);
  if (views <= 0.0) return estimate_transfer(options, known, motion, seed) / seconds_per_minute;
  const double stop = flight.rest_before() + flight.rest_after();
  const double leg = motion.leg_time({distance / views, 0.0, 0.0});
  return (estimate_transfer(options, known, motion, seed) + views * (leg + stop)) /
         seconds_per_minute;
}

double count_pixels(const survey::PlannerOptions& planner) {
  return static_cast<double>(planner.camera.width) * planner.camera.height;
}

/// Returns the predicted number of stored points.
double count_points(const survey::PlannerOptions& planner, const evaluation::SurveyScene& scene,
                    double views) {
  const double area = geometry::surface_area(scene.model());
  return std::min(packing * area / (planner.spacing * planner.spacing),
                  views * count_pixels(planner));
}

double estimate_memory(const survey::PlannerOptions& planner, const evaluation::SurveyScene& scene,
                       double views) {
  return base_bytes + a_triangle * static_cast<double>(scene.model().triangles.size()) +
         a_pixel * count_pixels(planner) + a_point * count_points(planner, scene, views);
}

SurveyWork survey_work(const session::SurveyOptions& options, const evaluation::SurveyScene& scene,
                       double views, double minutes) {
  const flight::CaptureOptions& capture = options.flight.capture;
  const double en_route =
      capture.is_moving ? seconds_per_minute * minutes / capture.frame_period : 0.0;
  return {.scans = views + en_route, .points = count_points(options.planner, scene, views)};
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
  double min = has_view_limit ? limit : std::min(limit, std::round(share.min * count));
  double max = has_view_limit ? limit : std::min(limit, std::round(share.max * count));
  // A scanner in flight measures nearly all during the initial pattern.
  double pattern = 0.0;
  if (asked.flight.capture.scans_in_flight() && !has_view_limit) {
    pattern = static_cast<double>(session::initial_pattern_views(asked.start, run.seed).size());
    min = 0.0;
    max = std::min(limit, std::round(0.5 * count));
  }
  const double minutes =
      asked.limits.max_time.value_or(std::numeric_limits<double>::max()) / seconds_per_minute;
  // The paths of planners can be shorter or longer than those of the oracle.
  constexpr double shorter = 0.8, longer = 1.05;
  const double min_minutes =
      std::min(minutes, shorter * estimate_minutes(asked, known, min, run.seed));
  const double max_minutes =
      std::min(minutes, longer * estimate_minutes(asked, known, max, run.seed));
  const PlanningPace pace = measure_pace(options, scene, run);
  const bool has_vehicle = asked.flight.has_vehicle();
  // The first views of a survey need more time than the others: they find most of the surface.
  constexpr double shortest = 0.6, longest = 1.1;
  const double least =
      shortest * planning_time(pace, survey_work(asked, scene, pattern + min, min_minutes),
                               pace.attainable, has_vehicle);
  const double most =
      longest * planning_time(pace, survey_work(asked, scene, pattern + max, max_minutes),
                              pace.max_attainable, has_vehicle);
  return {.known_views = known.size(),
          .min_views = static_cast<std::size_t>(pattern + min),
          .max_views = static_cast<std::size_t>(pattern + max),
          .min_minutes = min_minutes,
          .max_minutes = max_minutes,
          .memory = estimate_memory(asked.planner, scene, pattern + max),
          .min_time = least,
          .max_time = most};
}

}  // namespace skycap::missions::simulation
