#include "missions/derived/planner_factory.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "geometry/place/camera.h"
#include "missions/derived/site.h"

namespace skycap::missions::derived {
namespace {

/// Keeps the candidates' random numbers apart from those of the first view.
constexpr std::uint64_t candidates_stream = 0x766f6c756d657472;

/// A volumetric survey's V where neither mission nor benchmark says it: the paper's for its last
/// two models.
constexpr std::size_t usual_view_limit = 130;

survey::volumetric::VolumetricConfig volumetric_config(const file::Mission& mission,
                                                       survey::volumetric::VolumetricMetric metric,
                                                       unsigned threads) {
  const survey::volumetric::VolumetricSettings& settings = mission.volumetric;
  if (!settings.sphere_centre || !settings.sphere_radius) {
    throw Error(ErrorKind::bad_config,
                "the planner needs volumetric.sphere_centre and volumetric.sphere_radius where "
                "there is no model to derive them from; give both");
  }
  const survey::see::SeeConfig& see = mission.planner.see;
  const double views = static_cast<double>(view_limit(mission)) * settings.candidates_per_view;
  return {.metric = metric,
          .resolution = see.resolution_radius,
          .spacing = see.effective_spacing(),
          .scene_box = see.scene_box,
          .candidates = static_cast<std::size_t>(std::lround(views)),
          .sphere_centre = *settings.sphere_centre,
          .sphere_radius = *settings.sphere_radius,
          .least_height = see.least_height,
          .seed = mission.seed ^ candidates_stream,
          .settings = settings,
          .threads = threads};
}

/// The gain that a volumetric planner goes by; nothing for the others.
std::optional<survey::volumetric::VolumetricMetric> volumetric_metric(file::PlannerName name) {
  using enum survey::volumetric::VolumetricMetric;
  switch (name) {
    case file::PlannerName::rsv:
      return rear_side_voxel;
    case file::PlannerName::rse:
      return rear_side_entropy;
    case file::PlannerName::oa:
      return occlusion_aware;
    case file::PlannerName::uv:
      return unobserved_voxel;
    case file::PlannerName::pc:
      return proximity_count;
    case file::PlannerName::af:
      return area_factor;
    case file::PlannerName::ae:
      return average_entropy;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::size_t view_limit(const file::Mission& mission) {
  const bool is_volumetric = volumetric_metric(mission.planner.name).has_value();
  return is_volumetric ? std::min(mission.volumetric.view_limit.value_or(usual_view_limit),
                                  mission.limits.max_views)
                       : mission.limits.max_views;
}

std::unique_ptr<survey::Planner> make_planner(const file::Mission& mission, unsigned threads) {
  const geometry::Camera camera(mission.sensor.camera.camera);
  survey::see::SeeConfig see = mission.planner.see;
  see.threads = threads;
  if (const auto metric = volumetric_metric(mission.planner.name)) {
    return std::make_unique<survey::volumetric::VolumetricPlanner>(
        volumetric_config(mission, *metric, threads), camera);
  }
  if (mission.planner.name != file::PlannerName::skycap) {
    return std::make_unique<survey::see::SeePlanner>(see, camera);
  }
  survey::skycap::SkycapConfig config{
      .coverage_radius = mission.evaluation.registration_distance,
      .spacing = see.effective_spacing(),
      .view_distance = see.view_distance.value_or(view_distance(camera, see.density)),
      .max_incidence = mission.sensor.camera.max_incidence,
      .scene_box = see.scene_box,
      .limits = view_limits(mission),
      .stop = mission.planner.skycap_stop,
      .ideas = mission.planner.skycap_ideas,
      .threads = threads};
  // Told of the budgets, it looks for the best view that is still in reach.
  const file::LimitsConfig& limits = mission.limits;
  config.stop.most_length = limits.max_distance;
  if (limits.max_minutes) config.stop.most_time = 60.0 * *limits.max_minutes;
  config.stop.speed = limits.speed;
  config.stop.time_per_view = limits.time_per_view;
  return std::make_unique<survey::skycap::SkycapPlanner>(config, camera);
}

}  // namespace skycap::missions::derived
