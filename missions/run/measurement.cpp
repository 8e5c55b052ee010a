#include "missions/run/measurement.h"

#include <utility>

#include "missions/derived/mission_flight.h"

namespace skycap::missions::run {
namespace {

/// Keeps the noise of a mission that is flown again apart from the survey's.
constexpr std::uint64_t flown_again_stream = 0x666c6f776e206167;

/// What scans cover all of whose points are kept, as a recorder keeps them.
std::vector<std::uint8_t> scanned(const file::Mission& mission, const scene::SurveyScene& scene,
                                  const std::vector<geometry::View>& views, std::uint64_t seed,
                                  unsigned threads) {
  const derived::SurveySensor sensor(mission.sensor, seed);
  judge::CoverageMeter meter(scene.samples().points, mission.evaluation.registration_distance);
  geometry::Scan scan;
  for (std::size_t i = 0; i < views.size(); ++i) {
    scan = sensor.scan(scene.scene(), views[i], i, threads, std::move(scan));
    meter.add(scan.points);
  }
  return meter.is_covered();
}

}  // namespace

Measurement::Measurement(const file::Mission& mission, const scene::SurveyScene& scene,
                         std::uint64_t seed, unsigned threads)
    : scene_(scene),
      threads_(threads),
      sensor_(mission.sensor, seed),
      box_(mission.planner.see.scene_box.value_or(Eigen::AlignedBox3d())),
      cloud_(mission.planner.see.effective_spacing()),
      meter_(scene.samples().points, mission.evaluation.registration_distance) {}

std::vector<Eigen::Vector3f> Measurement::take(const geometry::View& view, std::size_t number) {
  const geometry::Scan scan = sensor_.scan(scene_.scene(), view, number, threads_);
  std::vector<Eigen::Vector3f> stored = cloud_.store(scan.points, box_);
  meter_.add(stored);
  return stored;
}

std::vector<std::uint8_t> covered_when_flown_again(const file::Mission& mission,
                                                   const scene::SurveyScene& scene,
                                                   const std::vector<geometry::View>& views,
                                                   std::uint64_t seed, unsigned threads) {
  seed ^= flown_again_stream;
  if (derived::scans_in_flight(mission)) return scanned(mission, scene, views, seed, threads);
  Measurement measured(mission, scene, seed, threads);
  for (std::size_t i = 0; i < views.size(); ++i) measured.take(views[i], i);
  return measured.meter().is_covered();
}

}  // namespace skycap::missions::run
