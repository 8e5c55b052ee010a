/// Gain of views: expected newly covered area, from the measured and the predicted surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/camera.h"
#include "geometry/pose/pose.h"
#include "survey/surfel/coverage_model.h"
#include "survey/surfel/predicted_surface.h"
#include "survey/surfel/raster/visibility_kernels.h"
#include "survey/surfel/surfel_map.h"
#include "survey/surfel/survey_estimate.h"

namespace skycap::survey::surfel {

/// Target in sight of a view.
struct VisibleTarget {
  std::uint32_t target;
  float covered_share;  ///< expected covered fraction of the uncovered area
  float line_of_sight_probability =
      1.0F;  ///< line-of-sight confidence, included in `covered_share`
};

/// Target in sight of a view, with the hazard of the observation (dose_model.h).
struct Observation {
  std::uint32_t target;
  float hazard;
};

struct Gain {
  double area = 0.0;       ///< expected newly covered area [m^2]
  double predicted = 0.0;  ///< part of the area that is only predicted [m^2]
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();  ///< centroid of the area [m]
};

struct GainSettings {
  double view_distance = 2.0;  ///< d [m]: determines the resolution of the visibility test
  float max_incidence =
      1.3614F;  ///< maximum angle of incidence with a return [rad]; default: 78 degrees, where the
                ///< ray density is one fifth of that at normal incidence
};

/// Snapshot of the measured and predicted surface that evaluates views. Immutable and thread-safe.
///
/// Targets are surfels with a relevant deficit and unobserved patches. Occlusion is tested in a
/// depth image of all surfels, drawn as squares of 2 h. Unobserved patches do not occlude, but
/// patches of prior_kind are also occluded by `prior_occluders`. `line_of_sight_probability`, if
/// given, is the line-of-sight confidence of patches and must outlive the field.
class GainField {
 public:
  GainField(const SurfelMap& map, std::span<const PredictedPatch> patches,
            const geometry::Camera& camera, const CoverageModel& coverage_model,
            const GainSettings& settings, std::span<const Eigen::Vector3f> prior_occluders = {},
            const LineOfSightModel* line_of_sight_probability = nullptr);

  /// Returns a field of the known surface as if it were unmeasured, for planning views that cover
  /// it from an empty cloud. Groups of consecutive surfels are represented by one target each, so
  /// that there are at most `max_targets`. The weight of a target is the area of its surfels times
  /// the trust in them.
  static GainField from_known_surface(const SurfelMap& map, const geometry::Camera& camera,
                                      const CoverageModel& coverage_model,
                                      const GainSettings& settings, std::size_t max_targets);

  struct Target {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;
    float weight;  ///< expected uncovered area [m^2]
  };
  /// Returns a field with the same occluders and other targets, which are assumed to exist.
  GainField with_targets(std::vector<Target> targets) const;

  std::span<const Target> targets() const { return targets_; }
  /// Returns the index of the surfel of target `i`, or of its unobserved patch if is_patch().
  std::uint32_t source(std::size_t target) const { return sources_[target]; }
  bool is_patch(std::size_t target) const { return target >= surfel_targets_; }

  Gain gain(const geometry::View& view) const;
  /// Returns the targets in sight of the view, ascending.
  std::vector<VisibleTarget> visible_targets(const geometry::View& view) const;
  /// Returns the targets in sight of the view, ascending, with the hazards of the observations.
  std::vector<Observation> observations(const geometry::View& view) const;

 private:
  /// Creates a field without targets.
  GainField(const SurfelMap& map, const geometry::Camera& camera,
            const CoverageModel& coverage_model, const GainSettings& settings);
  void index_targets();
  RasterView raster_view(const geometry::View& view) const;
  template <typename Visit>
  void for_each_visible_target(const geometry::View& view, Visit visit) const;
  bool is_prior(std::size_t target) const { return target >= first_prior_ && target < end_prior_; }

  CoverageModel coverage_model_;
  float spacing_;
  float min_cosine_;
  Eigen::Vector2f focal_length_px_;  ///< focal length of the sensor
  float min_range_, max_range_;
  Eigen::Vector2f half_slope_;  ///< tangents of half the field of view
  float raster_focal_length_px_;
  int raster_width_, raster_height_;
  std::array<std::vector<float>, 3> occluders_;  ///< x, y and z of all surfels
  std::array<std::vector<float>, 3> prior_occluders_;
  std::size_t surfel_targets_ = 0;
  std::size_t first_prior_ = 0, end_prior_ = 0;  ///< index range of the prior targets
  std::vector<Target> targets_;
  std::array<std::vector<float>, 3> positions_, normals_;  ///< target positions and normals
  std::vector<std::uint32_t> sources_;
  const LineOfSightModel* line_of_sight_model_ = nullptr;
};

/// Predicted effect of a view, with the state of the surface at the time of the prediction.
struct GainPrediction {
  std::vector<VisibleTarget> visible_targets;
  std::vector<float> hazards;  ///< hazards of the surfels
  double seen = 0.0,
         predicted = 0.0;  ///< predicted newly covered area of known and predicted surface [m^2]

  std::size_t surfels() const { return hazards.size(); }
};
GainPrediction compute_prediction(const GainField& field, const SurfelMap& map,
                                  std::vector<VisibleTarget> visible_targets);

/// Compares the prediction with the result. Lowers the trust in surfels that repeatedly gain less
/// than predicted and updates the hit rates of predicted patches.
void grade(const GainPrediction& gain_prediction, const GainField& field, SurfelMap& map,
           PredictedSurface& predicted, const FreeSpaceHistory& space);

/// Returns the coverable surface: the surfels of `map` and the unobserved `patches` in sight, with
/// their expected area times `prediction_yield`. `chances` contains the probability for each target
/// that a good view sees it, if it exists.
std::vector<EstimatedPatch> estimated_patches(const SurfelMap& map, const GainField& field,
                                              std::span<const PredictedPatch> patches,
                                              std::span<const float> chances,
                                              float prediction_yield);

}  // namespace skycap::survey::surfel
