#include "missions/cli/live_scene.h"

#include <vector>

#include <fmt/format.h>

#include "geometry/error.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/initial_pattern_flight.h"
#include "missions/support/identity.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::cli {
namespace {

/// Adds the scene's view sphere to an identity if the keys do not specify it.
support::Identity with_sphere(support::Identity identity, const survey::ViewSphere& sphere) {
  for (support::Setting& setting : identity.settings) {
    if (setting.value != "-") continue;
    if (setting.key == "volumetric.sphere_centre") {
      const Eigen::Vector3d& centre = sphere.centre;
      setting.value =
          fmt::format("[{:.12g}, {:.12g}, {:.12g}]", centre.x(), centre.y(), centre.z());
    } else if (setting.key == "volumetric.sphere_radius") {
      setting.value = fmt::format("{:.12g}", sphere.radius);
    }
  }
  return identity;
}

online::LiveStart start_without_scene(const session::StartOptions& start, std::uint64_t seed) {
  const std::vector<geometry::View> initial_pattern = session::initial_pattern_views(start, seed);
  return {initial_pattern.empty() ? start.view : initial_pattern.front(), {}};
}

}  // namespace

std::unique_ptr<online::LiveSurvey> open_survey(const config::MissionSetup& setup,
                                                const std::filesystem::path& mission_folder,
                                                const std::filesystem::path& survey_folder) {
  const auto open = [&](const support::Identity& identity, const online::LiveStart& start) {
    return std::make_unique<online::LiveSurvey>(setup.survey(), setup.live, identity, survey_folder,
                                                start, setup.run.threads);
  };
  const std::uint64_t seed = setup.run.seed;
  if (setup.scene().model.empty()) {
    return open(setup.identity(), start_without_scene(setup.survey().start, seed));
  }
  const evaluation::SurveyScene scene(setup.simulation, mission_folder, setup.run.threads);
  return open(with_sphere(setup.identity(), scene.view_sphere()),
              {scene.first_view(seed), scene.view_sphere()});
}

online::Sensor simulated_sensor(const evaluation::SimulationOptions& options,
                                const std::filesystem::path& mission_folder,
                                const session::RunOptions& run) {
  if (options.scene.model.empty()) {
    throw Error(ErrorKind::bad_config,
                "scene.model is missing; a simulated sensor requires a scene");
  }
  const auto scene =
      std::make_shared<evaluation::SurveyScene>(options, mission_folder, run.threads);
  const auto sensor = std::make_shared<sim::SurveySensor>(options.sensor, run.seed);
  return [scene, sensor, threads = run.threads](
             const geometry::View&, const geometry::View& actual_view, std::size_t number) {
    return sensor->scan(scene->scene(), actual_view, number, threads);
  };
}

}  // namespace skycap::missions::cli
