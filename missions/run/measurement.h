/// Views taken by the simulated sensor from an empty cloud, and what they cover of the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/place/pose.h"
#include "missions/derived/survey_sensor.h"
#include "missions/file/mission.h"
#include "missions/judge/coverage.h"
#include "missions/judge/thinned_cloud.h"
#include "missions/run/carried_sensor.h"
#include "missions/scene/survey_scene.h"

namespace skycap::missions::run {

class Measurement {
 public:
  /// Throws what the sensor throws. Keeps a reference to the scene.
  Measurement(const file::Mission& mission, const scene::SurveyScene& scene, std::uint64_t seed,
              unsigned threads);

  /// Frame `number`, from a sensor at rest; the same view has the same noise whenever it is taken.
  /// Stores what is at the mission's spacing from all that is stored, and gives it back.
  std::vector<Eigen::Vector3f> take(const geometry::View& view, std::size_t number);

  const judge::CoverageMeter& meter() const { return meter_; }

 private:
  const scene::SurveyScene& scene_;
  unsigned threads_;
  derived::SurveySensor sensor_;
  Eigen::AlignedBox3d box_;
  judge::ThinnedCloud cloud_;
  judge::CoverageMeter meter_;
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
CoveredAgain covered_when_flown_again(const file::Mission& mission, const scene::SurveyScene& scene,
                                      const std::vector<ViewInFlight>& views, std::uint64_t seed,
                                      unsigned threads);

}  // namespace skycap::missions::run
