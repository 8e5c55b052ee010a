/// Measurement of views with the simulated sensor, starting with an empty cloud, and their coverage
/// of the ground truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/pose/pose.h"
#include "missions/evaluation/coverage.h"
#include "missions/evaluation/downsampled_cloud.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/simulation/mounted_sensor.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::simulation {

class Measurement {
 public:
  /// Keeps a reference to the scene. Throws all errors of the sensor.
  Measurement(const evaluation::SimulationOptions& options, const evaluation::SurveyScene& scene,
              std::uint64_t seed, unsigned threads);

  /// Takes frame `number` with the sensor at rest. Noise depends only on the frame, not on the
  /// order of views. Stores and returns the points that are at least the mission's spacing away
  /// from all stored points.
  std::vector<Eigen::Vector3f> measure(const geometry::View& view, std::size_t number);

  const evaluation::CoverageMeter& meter() const { return meter_; }

 private:
  const evaluation::SurveyScene& scene_;
  unsigned threads_;
  sim::SurveySensor sensor_;
  Eigen::AlignedBox3d box_;
  evaluation::DownsampledCloud cloud_;
  evaluation::CoverageMeter meter_;
};

/// Coverage of a simulated re-flight: 1 for each covered sample of the scene.
struct CoveredAgain {
  /// Coverage by the downsampled cloud, as stored in a survey: points close to earlier points are
  /// omitted. For continuously measuring scanners, coverage by all points.
  std::vector<std::uint8_t> stored;
  std::vector<std::uint8_t> measured;  ///< Coverage by all points, as in a recording.
};

/// The points of a scan that is taken again: those stored at the mission's spacing (of a scanner
/// that measures in flight all), and all of them.
using VisitScan = std::function<void(std::span<const Eigen::Vector3f> stored,
                                     std::span<const Eigen::Vector3f> measured)>;

/// Returns the coverage of the views in a simulated re-flight. It starts from an empty cloud, with
/// noise different from that of the survey with the same seed. For a scanner that measures in
/// flight, the views are its scans. `visit`, if not empty, receives the points of each scan in
/// order. After a stop request, the result is incomplete.
CoveredAgain reflight_coverage(const evaluation::SimulationOptions& options,
                               const evaluation::SurveyScene& scene,
                               const std::vector<session::ViewInFlight>& views, std::uint64_t seed,
                               unsigned threads, const VisitScan& visit = {},
                               const std::stop_token& stop = {});

}  // namespace skycap::missions::simulation
