#include "missions/api/simulation.h"

#include "missions/api/mission_contents.h"
#include "missions/evaluation/survey_scene.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::api {

struct Simulation::Impl {
  explicit Impl(const Mission::Contents& contents)
      : scene(contents.setup.simulation, contents.folder, contents.setup.run.threads),
        sensor(contents.setup.sensor(), contents.setup.run.seed),
        seed(contents.setup.run.seed),
        threads(contents.setup.run.threads) {}

  evaluation::SurveyScene scene;
  sim::SurveySensor sensor;
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
