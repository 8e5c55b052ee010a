/// Views taken by the simulated sensor from an empty cloud, and what they cover of the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/place/pose.h"
#include "missions/evaluation/coverage.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/evaluation/thinned_cloud.h"
#include "missions/simulation/carried_sensor.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::simulation {

class Measurement {
 public:
  /// Throws what the sensor throws. Keeps a reference to the scene.
  Measurement(const evaluation::SimulationOptions& options, const evaluation::SurveyScene& scene,
              std::uint64_t seed, unsigned threads);

  /// Frame `number`, from a sensor at rest; the same view has the same noise whenever it is taken.
  /// Stores what is at the mission's spacing from all that is stored, and gives it back.
  std::vector<Eigen::Vector3f> take(const geometry::View& view, std::size_t number);

  const evaluation::CoverageMeter& meter() const { return meter_; }

 private:
  const evaluation::SurveyScene& scene_;
  unsigned threads_;
  sim::SurveySensor sensor_;
  Eigen::AlignedBox3d box_;
  evaluation::ThinnedCloud cloud_;
  evaluation::CoverageMeter meter_;
};

/// For each of the scene's samples, 1 if it is covered.
struct CoveredAgain {
  /// By what is stored at the mission's spacing, as a survey stores it: a point that lies near one
  /// that came before is left out. Of a scanner that measures in flight by all points.
  std::vector<std::uint8_t> stored;
  std::vector<std::uint8_t> measured;  ///< by all points, as a recorder keeps them
};

/// What the views cover when they are flown again: from an empty cloud, and with other noise than
/// the survey of that seed had. Of a scanner that measures in flight the views are its scans.
CoveredAgain covered_when_flown_again(const evaluation::SimulationOptions& options,
                                      const evaluation::SurveyScene& scene,
                                      const std::vector<session::ViewInFlight>& views,
                                      std::uint64_t seed, unsigned threads);

}  // namespace skycap::missions::simulation
