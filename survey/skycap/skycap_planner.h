/// Skycap's own planner: few views, from measurements alone.
///
/// It keeps what was measured (dose_map.h), what is known of space (space_memory.h) and guesses
/// where the surface goes on (unseen_surface.h). A view is worth the area that it is expected to
/// cover newly; the next one is the first stop of a short tour through views that complement each
/// other (chooser.h). Nothing needs tuning to a scene: every length derives from the sensor, the
/// coverage radius and the first scan. docs/explanation/skycap-planner.md has the formulas and what
/// each idea is worth.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/camera.h"
#include "survey/coverage_estimator.h"
#include "survey/planner.h"
#include "survey/skycap/skycap_config.h"
#include "survey/skycap/survey_belief.h"

namespace skycap::survey::skycap {

enum class SkycapStop {
  running,
  wanted_coverage,
  little_gain,  ///< no view promises enough, or the last four brought almost nothing
  most_length,
  most_time,
  nothing_in_reach,  ///< no admissible view sees anything that is missing
};

class SkycapPlanner final : public Planner, public CoverageEstimator {
 public:
  /// Throws what config.validate() throws.
  SkycapPlanner(const SkycapConfig& config, const geometry::Camera& camera);
  ~SkycapPlanner() override;

  /// `scan` may be organised (of the camera) or not: a sweep that shoots everywhere into the view
  /// of the camera, about as densely as its pixels lie, and maybe elsewhere too. Views are chosen
  /// by what the camera would see.
  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  /// As next_view(), but proposes nothing, and what the scan shows is not held against what views
  /// promised.
  void pass(const geometry::ScanSpan& scan) override;
  std::optional<geometry::View> next_view_instead() override;
  /// From now on only views at such places are proposed, by what is known when they are.
  void keep_to(PlaceCheck may_be_at) override;
  void stop_on(const std::stop_token& stop) override;
  const geometry::PointCloud& cloud() const override;
  geometry::PointCloud release_cloud() override;
  const PlanningStep& last_step() const override;
  StopReason stop_reason() const override;
  const CoverageEstimator* estimator() const override { return this; }

  /// Why the last call proposed nothing.
  SkycapStop stop() const;
  /// Expected covered share of the surface, seen and guessed.
  double predicted_coverage() const override;
  /// All that the planner believes of the surface. O(surfels).
  SurveyBelief belief() const override;
  std::string_view stop_rule() const override;
  /// What views would cover of all that was measured, from an empty cloud, by so many targets at
  /// most (GainField::of_known_surface()); null before the first scan.
  std::shared_ptr<const GainField> known_surface(std::size_t most_targets) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::survey::skycap
