/// What a survey leaves behind, simulated or live.
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
#include "survey/skycap/survey_belief.h"
#include "survey/survey_loop.h"

namespace skycap::missions::session {

/// A view of the survey and the coverage after it.
struct JudgedView {
  survey::SurveyedView surveyed;
  double coverage = 0.0;  ///< NaN where nobody knows the truth: of a live survey
};

/// A scan of a survey.
struct TakenScan {
  std::uint32_t view = 0;  ///< number of the view that it was taken at, or on the way to
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

/// What a survey left behind.
struct SurveyRecord {
  std::uint64_t seed = 1;
  unsigned threads = 1;
  survey::StopReason stop_reason = survey::StopReason::complete;
  std::vector<JudgedView> views;
  geometry::PointCloud cloud;
  /// The scans that the cloud's points are from; without any, each is a view's.
  std::vector<TakenScan> scans{};
  std::vector<std::uint8_t> is_covered;  ///< for each of the scene's samples
  std::optional<FlownSurvey> flown;      ///< of a mission with a vehicle

  /// What a planner that estimates coverage believed at the end; nothing with the others.
  std::optional<survey::skycap::SurveyBelief> belief;
  /// The surface that it measured, of a mission whose views are to be chosen anew; else null.
  std::shared_ptr<const survey::skycap::GainField> surface;
  /// The rule by which that planner stopped, see CoverageEstimator::stop_rule(); else empty.
  std::string stop_rule{};

  bool is_complete() const { return stop_reason == survey::StopReason::complete; }
  double coverage() const { return views.empty() ? 0.0 : views.back().coverage; }
  double distance() const { return views.empty() ? 0.0 : views.back().surveyed.distance; }
  std::size_t frames_on_way() const;
  double planning_time() const;
  double sensing_time() const;
};

/// The word for it in files.
using survey::name_of;

/// The reason of that name. Throws Error{bad_file}.
survey::StopReason stop_reason_named(const std::string& name);

}  // namespace skycap::missions::session
