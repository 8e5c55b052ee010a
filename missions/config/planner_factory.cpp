#include "missions/config/planner_factory.h"

#include <algorithm>
#include <cmath>

#include "flight/motion/motion.h"
#include "flight/route/route.h"
#include "geometry/error.h"
#include "geometry/place/camera.h"
#include "missions/config/mission_flight.h"
#include "missions/config/mission_priors.h"
#include "missions/config/planner_titles.h"
#include "missions/config/scanner_field.h"
#include "missions/config/site.h"
#include "missions/support/number_text.h"
#include "survey/see/see.h"
#include "survey/skycap/skycap_planner.h"
#include "survey/volumetric/volumetric_planner.h"

namespace skycap::missions::config {
namespace {

/// Keeps the candidates' random numbers apart from those of the first view.
constexpr std::uint64_t candidates_stream = 0x766f6c756d657472;

/// A volumetric survey's V where neither mission nor benchmark says it: the paper's for its last
/// two models.
constexpr std::size_t usual_view_limit = 130;

survey::volumetric::VolumetricConfig volumetric_config(const config::Mission& mission,
                                                       survey::volumetric::VolumetricMetric metric,
                                                       unsigned threads) {
  const survey::volumetric::VolumetricSettings& settings = mission.volumetric;
  const survey::see::SeeConfig& see = mission.planner.see;
  const double views = static_cast<double>(view_limit(mission)) * settings.candidates_per_view;
  survey::volumetric::VolumetricConfig config{
      .metric = metric,
      .resolution = see.resolution_radius,
      .spacing = see.effective_spacing(),
      .scene_box = see.scene_box,
      .candidates = static_cast<std::size_t>(std::lround(views)),
      .least_height = least_view_height(mission),
      .seed = mission.seed ^ candidates_stream,
      .settings = settings,
      .threads = threads};
  if (settings.sphere_centre) config.sphere_centre = *settings.sphere_centre;
  if (settings.sphere_radius) config.sphere_radius = *settings.sphere_radius;
  return config;
}

survey::see::SeeConfig see_config(const config::Mission& mission, unsigned threads) {
  survey::see::SeeConfig config = mission.planner.see;
  config.threads = threads;
  config.least_height = least_view_height(mission);
  return config;
}

/// What a stop costs, as metres of way at the cruise speed: the rest, and the ramps of the straight
/// pieces that lead there, two and a half in surveys of buildings.
double price_of_stop(const config::Mission& mission) {
  constexpr double pieces = 2.5, long_way = 100.0;
  const flight::Motion motion(vehicle_of(mission),
                              route_options_of(mission, Eigen::Vector3d::Zero()).conditions);
  const double speed = motion.leg_speed(Eigen::Vector3d::UnitX());
  const double ramps = motion.leg_time({long_way, 0.0, 0.0}) - long_way / speed;
  return speed *
         (hold_of(mission) + hold_after_of(mission) + pieces * (ramps + flight::corner_hold));
}

}  // namespace

std::optional<double> view_price_of(const config::Mission& mission) {
  if (mission.planner.goal == config::PlannerGoal::views) return std::nullopt;
  return mission.flight.is_flown() ? price_of_stop(mission) : view_distance_of(mission);
}

namespace {

survey::skycap::SkycapConfig skycap_config(const config::Mission& mission, unsigned threads) {
  const survey::see::SeeConfig& see = mission.planner.see;
  survey::skycap::SkycapConfig config{.coverage_radius = mission.evaluation.registration_distance,
                                      .spacing = see.effective_spacing(),
                                      .view_distance = view_distance_of(mission),
                                      .max_incidence = mission.sensor.camera.max_incidence,
                                      .scene_box = see.scene_box,
                                      .limits = view_limits(mission),
                                      .stop = mission.planner.skycap_stop,
                                      .ideas = mission.planner.skycap_ideas,
                                      .threads = threads};
  // Told of the budgets, it looks for the best view that is still in reach.
  const config::LimitsConfig& limits = mission.limits;
  config.stop.most_length = limits.max_distance;
  if (limits.max_minutes) config.stop.most_time = 60.0 * *limits.max_minutes;
  config.stop.speed = limits.speed;
  config.stop.time_per_view = limits.time_per_view;
  config.view_price = view_price_of(mission);
  if (mission.sensor.is_moving()) {
    config.frame_spacing = mission.flight.cruise_speed * mission.sensor.frame_period;
    const auto& scanner = mission.sensor.scanner;
    config.counts_ways = scanner && kind_of(*scanner) != ScannerKind::ring;
    config.sees_lines = scanner && kind_of(*scanner) == ScannerKind::line;
  }
  if (mission.flight.is_flown()) {  // as if they were the same along and about all axes
    const sim::NavigationErrors& poses = mission.scan.navigation;
    const auto mean = [](double twice, double once) {
      return std::sqrt((2.0 * twice * twice + once * once) / 3.0);
    };
    config.place_error = mean(poses.horizontal_sigma, poses.vertical_sigma);
    config.angle_error = mean(poses.tilt_sigma, poses.heading_sigma);
  }
  return config;
}

/// Throws if the candidates' sphere, where both of its keys are given, is below the least height.
void validate_sphere(const survey::volumetric::VolumetricConfig& config) {
  const survey::volumetric::VolumetricSettings& settings = config.settings;
  if (!settings.sphere_centre || !settings.sphere_radius || !config.least_height) return;
  const double highest = config.sphere_centre.z() + config.sphere_radius;
  if (highest > *config.least_height) return;
  throw Error(ErrorKind::bad_config,
              "volumetric.sphere_radius is " + support::short_text(config.sphere_radius) +
                  "; it must be large enough for the sphere to reach above the least height of " +
                  support::short_text(*config.least_height) +
                  " m, which limits.ground_clearance gives");
}

}  // namespace

std::size_t view_limit(const config::Mission& mission) {
  const bool is_volumetric = config::title_of(mission.planner.name).metric.has_value();
  return is_volumetric ? std::min(mission.volumetric.view_limit.value_or(usual_view_limit),
                                  mission.limits.max_views)
                       : mission.limits.max_views;
}

void validate_planner(const config::Mission& mission) {
  if (const auto metric = config::title_of(mission.planner.name).metric) {
    const auto config = volumetric_config(mission, *metric, 1);
    config.validate();
    validate_sphere(config);
  } else if (mission.planner.name == config::PlannerName::skycap) {
    skycap_config(mission, 1).validate();
  } else {
    see_config(mission, 1).validate();
  }
}

std::unique_ptr<survey::Planner> make_planner(const config::Mission& mission, unsigned threads) {
  const geometry::Camera camera(mission.sensor.camera.camera);
  if (const auto metric = config::title_of(mission.planner.name).metric) {
    if (!mission.volumetric.sphere_centre || !mission.volumetric.sphere_radius) {
      throw Error(ErrorKind::bad_config,
                  "the planner needs volumetric.sphere_centre and volumetric.sphere_radius where "
                  "there is no model to derive them from; give both");
    }
    return std::make_unique<survey::volumetric::VolumetricPlanner>(
        volumetric_config(mission, *metric, threads), camera);
  }
  if (mission.planner.name == config::PlannerName::skycap) {
    survey::skycap::SkycapConfig config = skycap_config(mission, threads);
    config.prior = prior_surface(mission);
    return std::make_unique<survey::skycap::SkycapPlanner>(config, camera);
  }
  return std::make_unique<survey::see::SeePlanner>(see_config(mission, threads), camera);
}

}  // namespace skycap::missions::config
