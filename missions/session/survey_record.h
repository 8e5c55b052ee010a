/// Result of a survey, simulated or live.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_cloud.h"
#include "missions/session/survey_flight.h"
#include "survey/coverage_estimator.h"
#include "survey/surfel/survey_estimate.h"
#include "survey/survey_loop.h"

namespace skycap::missions::session {

/// View of the survey with the coverage after it.
struct EvaluatedView {
  survey::SurveyedView surveyed;
  /// Coverage after the view. NaN for live surveys, which have no ground truth.
  double coverage = 0.0;
};

/// Scan of a survey.
struct RecordedScan {
  std::uint32_t view = 0;  ///< View at which, or on the path to which, the scan was taken.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

/// Result of a survey.
struct SurveyRecord {
  std::uint64_t seed = 1;
  unsigned threads = 1;
  survey::StopReason stop_reason = survey::StopReason::complete;
  std::vector<EvaluatedView> views;
  geometry::PointCloud cloud;
  /// Scans that the views of the cloud's points refer to. If empty, they refer to `views`.
  std::vector<RecordedScan> scans{};
  std::vector<std::uint8_t> is_covered;  ///< Whether each sample of the scene is covered.
  std::optional<FlightRecord>
      flight_record;  ///< Flight of a mission with a vehicle; otherwise empty.

  /// Final estimate of planners that estimate coverage; otherwise empty.
  std::optional<survey::surfel::SurveyEstimate> estimate;
  /// Measured surface, if the views may be replanned; otherwise null.
  std::shared_ptr<const survey::surfel::GainField> surface;
  /// Completion rule of the planner, see CoverageEstimator::stop_rule(); empty for other planners.
  std::string stop_rule{};

  /// Views of the flown pattern; otherwise empty.
  std::optional<survey::PatternRecord> pattern{};

  bool is_complete() const { return stop_reason == survey::StopReason::complete; }
  double coverage() const { return views.empty() ? 0.0 : views.back().coverage; }
  double distance() const { return views.empty() ? 0.0 : views.back().surveyed.distance; }
  std::size_t en_route_frames() const;
  double planning_time() const;
  double sensing_time() const;
};

/// Returns the name of a stop reason in files.
using survey::to_string;

/// Returns the stop reason with this name. Throws Error{bad_file}.
survey::StopReason stop_reason_named(const std::string& name);

}  // namespace skycap::missions::session
