/// Settings common to all planners, and a factory of planners.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <variant>

#include <Eigen/Geometry>

#include "geometry/pose/camera.h"
#include "survey/external/external_planner.h"
#include "survey/fixed_views/fixed_views_config.h"
#include "survey/patterns/pattern_config.h"
#include "survey/pb_nbv/pb_nbv_config.h"
#include "survey/planner.h"
#include "survey/planners/planner_names.h"
#include "survey/see/see_config.h"
#include "survey/surfel/surfel_config.h"
#include "survey/view_limits.h"
#include "survey/volumetric/volumetric_config.h"

namespace skycap::survey {

/// Sphere that contains the first view and all views of the volumetric planners. Its centre is the
/// centroid of the surface. Its radius is d plus the mean distance of the surface from the centre
/// (paper §IV-B).
struct ViewSphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

struct PlannerOptions {
  PlannerName name = PlannerName::see_plus_plus;
  geometry::CameraConfig camera;  ///< camera model for view selection

  double spacing = 0.00261711877;                ///< epsilon: minimum distance of stored points [m]
  double view_distance = 1.0;                    ///< d: distance of views from the surface [m]
  double resolution_radius = 0.017;              ///< r: size of the smallest resolved features [m]
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are ignored
  double max_incidence =
      1.5707963267948966;  ///< maximum angle between ray and normal with a return [rad]
  ViewLimits limits;

  /// Settings of the planner `name`. Seed, threads, prior surface and a sphere that the mission
  /// does not set are completed by make_planner().
  std::variant<see::SeeConfig, surfel::SurfelConfig, volumetric::VolumetricConfig,
               pb_nbv::PbNbvConfig, fixed_views::FixedViewsConfig, patterns::PatternConfig,
               external::ExternalConfig>
      method;

  /// Returns the prior surface of the targets. Called on demand; may be empty.
  std::function<std::shared_ptr<const surfel::PriorSurface>()> prior_surface;

  /// Throws Error{bad_config} "FIELD is ...; it must be ..." for the first setting that the planner
  /// does not accept. A missing sphere is accepted.
  void validate() const;
};

/// Parameters of one run of a planner.
struct PlannerRun {
  std::uint64_t seed = 1;
  unsigned threads = 1;  ///< zero: all processors; does not affect the plan
  /// Sphere of volumetric planners and fixed views whose settings have none.
  std::optional<ViewSphere> sphere;
  /// Returns whether the true scene admits a view. Only for fixed views, which are no planner and
  /// are granted this knowledge; empty: unknown, as in live surveys.
  std::function<bool(const geometry::View&)> true_scene_admits{};
  /// Target of patterns whose settings have none, granted by a simulated scene.
  std::optional<patterns::PatternTarget> pattern_target{};
};

/// Creates the planner and applies the limits. Throws Error{bad_config} for a volumetric planner
/// and for fixed views without a sphere, and the errors of a user's planner.
std::unique_ptr<Planner> make_planner(const PlannerOptions& options, const PlannerRun& run);

}  // namespace skycap::survey
