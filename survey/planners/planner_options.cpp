#include "survey/planners/planner_options.h"

#include <utility>

#include <Eigen/Core>

#include "geometry/error.h"
#include "survey/external/external_planner.h"
#include "survey/fixed_views/fixed_view_planner.h"
#include "survey/limited_planner.h"
#include "survey/patterns/pattern_planner.h"
#include "survey/pb_nbv/pb_nbv_planner.h"
#include "survey/see/see.h"
#include "survey/surfel/surfel_planner.h"
#include "survey/volumetric/volumetric_planner.h"

namespace skycap::survey {
namespace {

using volumetric::VolumetricConfig;

/// Separates the random numbers of the candidates from those of the first view.
constexpr std::uint64_t candidates_stream = 0x766f6c756d657472;

std::unique_ptr<Planner> limited(std::unique_ptr<Planner> planner, const ViewLimits& limits) {
  return std::make_unique<LimitedPlanner>(std::move(planner), limits);
}

/// Creates each kind of planner from its settings.
struct Maker {
  const PlannerOptions& options;
  const PlannerRun& run;
  geometry::Camera camera;

  std::unique_ptr<Planner> operator()(see::SeeConfig config) const {
    config.threads = run.threads;
    return limited(std::make_unique<see::SeePlanner>(config, camera), options.limits);
  }

  std::unique_ptr<Planner> operator()(surfel::SurfelConfig config) const {
    config.threads = run.threads;
    if (options.prior_surface) config.prior = options.prior_surface();
    return std::make_unique<surfel::SurfelPlanner>(config, camera);  // supports limits itself
  }

  std::unique_ptr<Planner> operator()(VolumetricConfig config) const {
    const volumetric::VolumetricSettings& given = config.settings;
    const ViewSphere sphere = complete_sphere(given.sphere_centre, given.sphere_radius);
    config.sphere_centre = sphere.centre;
    config.sphere_radius = sphere.radius;
    config.seed = run.seed ^ candidates_stream;
    config.threads = run.threads;
    return limited(std::make_unique<volumetric::VolumetricPlanner>(config, camera), options.limits);
  }

  std::unique_ptr<Planner> operator()(pb_nbv::PbNbvConfig config) const {
    config.seed = run.seed;
    config.threads = run.threads;
    return limited(std::make_unique<pb_nbv::PbNbvPlanner>(config, camera), options.limits);
  }

  std::unique_ptr<Planner> operator()(fixed_views::FixedViewsConfig config) const {
    const ViewSphere sphere = complete_sphere(config.sphere_centre, config.sphere_radius);
    config.centre = sphere.centre;
    config.radius = sphere.radius;
    config.seed = run.seed ^ candidates_stream;
    config.admits = run.true_scene_admits;
    return limited(std::make_unique<fixed_views::FixedViewPlanner>(config), options.limits);
  }

  std::unique_ptr<Planner> operator()(patterns::PatternConfig config) const {
    if (!config.target) config.target = run.pattern_target;
    return limited(std::make_unique<patterns::PatternPlanner>(config), options.limits);
  }

  std::unique_ptr<Planner> operator()(external::ExternalConfig config) const {
    config.task.seed = run.seed;
    return limited(std::make_unique<external::ExternalPlanner>(config), options.limits);
  }

  /// Completes the sphere set by the mission with that of the scene.
  ViewSphere complete_sphere(const std::optional<Eigen::Vector3d>& centre,
                             const std::optional<double>& radius) const {
    if ((!centre || !radius) && !run.sphere) {
      throw Error(ErrorKind::bad_config,
                  "the planner requires volumetric.sphere_centre and volumetric.sphere_radius if "
                  "they cannot be derived from a model; set both");
    }
    return {centre ? *centre : run.sphere->centre, radius ? *radius : run.sphere->radius};
  }
};

}  // namespace

void PlannerOptions::validate() const {
  std::visit([](const auto& config) { config.validate(); }, method);
}

std::unique_ptr<Planner> make_planner(const PlannerOptions& options, const PlannerRun& run) {
  return std::visit(Maker{options, run, geometry::Camera(options.camera)}, options.method);
}

}  // namespace skycap::survey
