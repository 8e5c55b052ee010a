#include "survey/planners/planner_options.h"

#include <utility>

#include <Eigen/Core>

#include "geometry/error.h"
#include "survey/limited_planner.h"
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
    if ((!given.sphere_centre || !given.sphere_radius) && !run.sphere) {
      throw Error(ErrorKind::bad_config,
                  "the planner requires volumetric.sphere_centre and volumetric.sphere_radius if "
                  "they cannot be derived from a model; set both");
    }
    config.sphere_centre = given.sphere_centre ? *given.sphere_centre : run.sphere->centre;
    config.sphere_radius = given.sphere_radius ? *given.sphere_radius : run.sphere->radius;
    config.seed = run.seed ^ candidates_stream;
    config.threads = run.threads;
    return limited(std::make_unique<volumetric::VolumetricPlanner>(config, camera), options.limits);
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
