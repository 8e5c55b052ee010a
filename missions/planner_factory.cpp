#include "missions/planner_factory.h"

#include <algorithm>
#include <cmath>

#include "geometry/camera.h"
#include "geometry/error.h"
#include "missions/site.h"

namespace skycap::missions {
namespace {

/// Keeps the candidates' random numbers apart from those of the first view.
constexpr std::uint64_t candidates_stream = 0x766f6c756d657472;

/// A volumetric survey's V where neither mission nor benchmark says it: the paper's for its last
/// two models.
constexpr std::size_t usual_view_limit = 130;

survey::VolumetricConfig volumetric_config(const Mission& mission, survey::VolumetricMetric metric,
                                           unsigned threads) {
  const survey::VolumetricSettings& settings = mission.volumetric;
  if (!settings.sphere_centre || !settings.sphere_radius) {
    throw Error(ErrorKind::bad_config,
                "the planner needs volumetric.sphere_centre and volumetric.sphere_radius where "
                "there is no model to derive them from; give both");
  }
  const survey::SeeConfig& see = mission.planner.see;
  const double views = static_cast<double>(view_limit(mission)) * settings.candidates_per_view;
  return {.metric = metric,
          .resolution = see.resolution_radius,
          .spacing = see.effective_spacing(),
          .scene_box = see.scene_box,
          .candidates = static_cast<std::size_t>(std::lround(views)),
          .sphere_centre = *settings.sphere_centre,
          .sphere_radius = *settings.sphere_radius,
          .least_height = see.ground_clearance,
          .seed = mission.seed ^ candidates_stream,
          .settings = settings,
          .threads = threads};
}

}  // namespace

std::optional<survey::VolumetricMetric> volumetric_metric(PlannerName name) {
  using enum survey::VolumetricMetric;
  switch (name) {
    case PlannerName::rsv:
      return rear_side_voxel;
    case PlannerName::rse:
      return rear_side_entropy;
    case PlannerName::oa:
      return occlusion_aware;
    case PlannerName::uv:
      return unobserved_voxel;
    case PlannerName::pc:
      return proximity_count;
    case PlannerName::af:
      return area_factor;
    case PlannerName::ae:
      return average_entropy;
    default:
      return std::nullopt;
  }
}

std::size_t view_limit(const Mission& mission) {
  const bool is_volumetric = volumetric_metric(mission.planner.name).has_value();
  return is_volumetric ? std::min(mission.volumetric.view_limit.value_or(usual_view_limit),
                                  mission.limits.max_views)
                       : mission.limits.max_views;
}

std::unique_ptr<survey::Planner> make_planner(const Mission& mission, unsigned threads) {
  const geometry::Camera camera(mission.sensor.camera.camera);
  survey::SeeConfig see = mission.planner.see;
  see.threads = threads;
  if (const auto metric = volumetric_metric(mission.planner.name)) {
    return std::make_unique<survey::VolumetricPlanner>(volumetric_config(mission, *metric, threads),
                                                       camera);
  }
  if (mission.planner.name != PlannerName::skycap) {
    return std::make_unique<survey::SeePlanner>(see, camera);
  }
  survey::SkycapConfig config{
      .coverage_radius = mission.evaluation.registration_distance,
      .spacing = see.effective_spacing(),
      .view_distance = see.view_distance.value_or(view_distance(camera, see.density)),
      .scene_box = see.scene_box,
      .limits = view_limits(mission),
      .stop = mission.planner.skycap_stop,
      .ideas = mission.planner.skycap_ideas,
      .threads = threads};
  // Told of the budgets, it looks for the best view that is still in reach.
  const LimitsConfig& limits = mission.limits;
  if (limits.max_distance < LimitsConfig{}.max_distance) {
    config.stop.most_length = limits.max_distance;
  }
  if (limits.max_minutes) config.stop.most_time = 60.0 * *limits.max_minutes;
  config.stop.speed = limits.speed;
  config.stop.time_per_view = limits.time_per_view;
  return std::make_unique<survey::SkycapPlanner>(config, camera);
}

}  // namespace skycap::missions
