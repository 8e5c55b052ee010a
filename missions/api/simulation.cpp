#include "missions/api/simulation.h"

#include "missions/api/mission_contents.h"
#include "missions/config/survey_sensor.h"
#include "missions/evaluation/survey_scene.h"

namespace skycap::missions::api {

struct Simulation::Impl {
  explicit Impl(const Mission::Contents& contents)
      : scene(contents.mission, contents.folder),
        sensor(contents.mission.sensor, contents.mission.seed),
        seed(contents.mission.seed),
        threads(contents.mission.threads) {}

  evaluation::SurveyScene scene;
  config::SurveySensor sensor;
  std::uint64_t seed;
  unsigned threads;
};

Simulation::Simulation(const Mission& mission)
    : impl_(std::make_unique<Impl>(mission.contents())) {}

Simulation::~Simulation() = default;

geometry::View Simulation::first_view() const { return impl_->scene.first_view(impl_->seed); }

geometry::Scan Simulation::scan(const geometry::View& view, std::uint64_t frame) const {
  return impl_->sensor.scan(impl_->scene.scene(), view, frame, impl_->threads);
}

}  // namespace skycap::missions::api
