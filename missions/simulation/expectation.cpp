#include "missions/simulation/expectation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "geometry/surfaces/mesh.h"
#include "missions/simulation/omniscient.h"
#include "sim/sensors/survey_sensor.h"
#include "survey/planners/planner_names.h"
#include "survey/planners/planner_options.h"

namespace skycap::missions::simulation {
namespace {

using geometry::View;

constexpr OmniscientConfig few{.candidates = 400, .samples = 2000, .wanted_coverage = {}};

// Bytes of the whole program, from the peak memory of surveys of the shipped missions.
constexpr double of_program = 5e7;
constexpr double a_triangle = 150.0;
constexpr double a_pixel = 50.0;
constexpr double a_point = 60.0;
constexpr double seconds_per_minute = 60.0;
constexpr double packing = 0.7;  // Stored points per square of their spacing.

/// Ratio between the numbers of views of a planner and of the oracle in the surveys of docs/.
struct Share {
  double least, most;
};

Share share_of(survey::PlannerName planner) {
  switch (planner) {
    case survey::PlannerName::skycap:
      return {1.1, 2.0};
    case survey::PlannerName::see_plus_plus:
      return {1.3, 4.0};
    default:
      return {6.0, 9.0};
  }
}

double way_of(const std::vector<View>& views) {
  double way = 0.0;
  for (std::size_t i = 1; i < views.size(); ++i) {
    way += (views[i].position - views[i - 1].position).norm();
  }
  return way;
}

/// Returns the flight time for a number of views [min]. The path length grows with the square root
/// of this number, as for tours.
double minutes_of(const session::SurveyOptions& options, const std::vector<View>& known,
                  double views) {
  const flight::FlightOptions& flight = options.flight;
  const bool is_flown = flight.is_flown();
  const double speed = is_flown ? flight.cruise_speed : options.limits.speed;
  const double stop =
      is_flown ? flight.rest_before() + flight.rest_after() : options.limits.time_per_view;
  const double more = std::sqrt(views / static_cast<double>(known.size()));
  return (way_of(known) * more / speed + views * stop) / seconds_per_minute;
}

double memory_of(const survey::PlannerOptions& planner, const evaluation::SurveyScene& scene,
                 double views) {
  const auto pixels = static_cast<double>(planner.camera.width) * planner.camera.height;
  const double spacing = planner.spacing;
  const double area = geometry::surface_area(scene.model());
  const double points = std::min(packing * area / (spacing * spacing), views * pixels);
  return of_program + a_triangle * static_cast<double>(scene.model().triangles.size()) +
         a_pixel * pixels + a_point * points;
}

/// Returns the time to measure and plan the first view [s].
double time_of_a_view(const evaluation::SimulationOptions& options,
                      const evaluation::SurveyScene& scene, const session::RunOptions& run) {
  const auto planner = survey::make_planner(
      options.survey.planner,
      {.seed = run.seed, .threads = run.threads, .sphere = scene.view_sphere()});
  const sim::SurveySensor sensor(options.sensor, run.seed);
  const auto begun = std::chrono::steady_clock::now();
  planner->next_view(sensor.scan(scene.scene(), scene.first_view(run.seed), 0, run.threads));
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

}  // namespace

Expectation expectation(const evaluation::SimulationOptions& options,
                        const evaluation::SurveyScene& scene, const session::RunOptions& run) {
  const session::SurveyOptions& asked = options.survey;
  const std::vector<View> known = known_cover(options, scene, run.seed, run.threads, few);
  const double limit = static_cast<double>(asked.limits.max_views);
  const auto count = static_cast<double>(known.size());
  const bool is_volumetric = survey::title_of(asked.planner.name).metric.has_value();
  const Share share = share_of(asked.planner.name);
  const double least = is_volumetric ? limit : std::min(limit, std::round(share.least * count));
  const double most = is_volumetric ? limit : std::min(limit, std::round(share.most * count));
  const double minutes =
      asked.limits.max_time.value_or(std::numeric_limits<double>::max()) / seconds_per_minute;
  const double time = time_of_a_view(options, scene, run);
  return {.known_views = known.size(),
          .least_views = static_cast<std::size_t>(least),
          .most_views = static_cast<std::size_t>(most),
          .least_minutes = std::min(minutes, minutes_of(asked, known, least)),
          .most_minutes = std::min(minutes, minutes_of(asked, known, most)),
          .memory = memory_of(asked.planner, scene, most),
          .least_time = time * least,
          .most_time = time * most};
}

}  // namespace skycap::missions::simulation
