#include "missions/simulation/measurement.h"

#include <utility>

#include "missions/simulation/mounted_sensor.h"

namespace skycap::missions::simulation {
namespace {

/// Random stream of simulated re-flights, separate from that of surveys.
constexpr std::uint64_t reflight_stream = 0x666c6f776e206167;

}  // namespace

Measurement::Measurement(const evaluation::SimulationOptions& options,
                         const evaluation::SurveyScene& scene, std::uint64_t seed, unsigned threads)
    : scene_(scene),
      threads_(threads),
      sensor_(options.sensor, seed),
      box_(options.scene_box()),
      cloud_(options.survey.planner.spacing),
      meter_(scene.samples().points, options.evaluation.registration_distance) {}

std::vector<Eigen::Vector3f> Measurement::measure(const geometry::View& view, std::size_t number) {
  const geometry::Scan scan = sensor_.scan(scene_.scene(), view, number, threads_);
  std::vector<Eigen::Vector3f> stored = cloud_.store(scan.points, box_);
  meter_.add(stored);
  return stored;
}

CoveredAgain reflight_coverage(const evaluation::SimulationOptions& options,
                               const evaluation::SurveyScene& scene,
                               const std::vector<session::ViewInFlight>& views, std::uint64_t seed,
                               unsigned threads, const VisitScan& visit,
                               const std::stop_token& stop) {
  MountedSensor sensor(options, seed ^ reflight_stream);
  const double near = options.evaluation.registration_distance;
  evaluation::CoverageMeter stored(scene.samples().points, near),
      measured(scene.samples().points, near);
  evaluation::DownsampledCloud cloud(options.survey.planner.spacing);
  const Eigen::AlignedBox3d box = options.scene_box();
  const bool keeps_all = options.sensor.scans_in_flight();
  geometry::Scan scan;
  for (std::size_t i = 0; i < views.size() && !stop.stop_requested(); ++i) {
    scan = sensor.scan(scene.scene(), views[i], i, threads, std::move(scan));
    measured.add(scan.points);
    if (keeps_all) {
      if (visit) visit(scan.points, scan.points);
      continue;
    }
    const std::vector<Eigen::Vector3f> kept = cloud.store(scan.points, box);
    stored.add(kept);
    if (visit) visit(kept, scan.points);
  }
  return {keeps_all ? measured.is_covered() : stored.is_covered(), measured.is_covered()};
}

}  // namespace skycap::missions::simulation
