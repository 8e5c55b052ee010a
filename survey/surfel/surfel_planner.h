/// Skycap's own planner, which needs few views and uses only measurements.
///
/// The planner maintains the measured surface (dose_map.h), the free-space memory (space_memory.h)
/// and a prediction of unobserved surface (surface_prediction.h). The gain of a view is the area
/// that it is expected to cover newly. The next view is the first stop of a short tour through
/// complementary views. No parameter needs tuning to a scene: all lengths derive from the sensor,
/// the coverage radius and the first scan. docs/explanation/skycap-planner-formulas.md contains the
/// formulas and an ablation study.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/camera.h"
#include "survey/coverage_estimator.h"
#include "survey/planner.h"
#include "survey/surfel/surfel_config.h"
#include "survey/surfel/survey_estimate.h"

namespace skycap::survey::surfel {

enum class SurfelStop {
  running,
  target_coverage,
  little_gain,  ///< the predicted gain is too small, or the last eight scans covered almost nothing
  max_length,
  max_time,
  nothing_in_reach,  ///< no admissible view sees uncovered surface
};

class SurfelPlanner final : public Planner, public CoverageEstimator {
 public:
  /// Throws the errors of config.validate().
  SurfelPlanner(const SurfelConfig& config, const geometry::Camera& camera);
  ~SurfelPlanner() override;

  /// `scan` may be organised (an image of the camera) or a sweep. A sweep must cover the field of
  /// view of the camera with about the density of its pixels, and may extend beyond it. Views are
  /// selected by what the camera would see.
  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  /// Processes a scan like next_view(), but proposes no view and does not compare the scan with the
  /// predicted gain.
  void pass(const geometry::ScanSpan& scan) override;
  std::optional<geometry::View> next_alternative_view() override;
  /// Restricts subsequent proposals to positions allowed by `may_be_at` at the time of the
  /// proposal.
  void keep_to(PositionCheck may_be_at) override;
  void stop_on(const std::stop_token& stop) override;
  const geometry::PointCloud& cloud() const override;
  geometry::PointCloud take_cloud() override;
  const PlanningStep& last_step() const override;
  StopReason stop_reason() const override;
  const CoverageEstimator* estimator() const override { return this; }

  /// Returns why the last call proposed no view.
  SurfelStop stop() const;
  /// Returns the expected covered fraction of the measured and predicted surface.
  double predicted_coverage() const override;
  /// Returns the complete estimate of the surface. Complexity: O(surfels).
  SurveyEstimate estimate() const override;
  std::string_view stop_rule() const override;
  /// Returns GainField::from_known_surface() with at most `max_targets` targets, or null before the
  /// first scan.
  std::shared_ptr<const GainField> known_surface(std::size_t max_targets) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::survey::surfel
