/// What a survey asks of its planner, whichever it is, and the planner made from that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <variant>

#include <Eigen/Geometry>

#include "geometry/place/camera.h"
#include "survey/planner.h"
#include "survey/planners/planner_names.h"
#include "survey/see/see_config.h"
#include "survey/skycap/skycap_config.h"
#include "survey/view_limits.h"
#include "survey/volumetric/volumetric_config.h"

namespace skycap::survey {

/// Where the first view, and all views of the volumetric planners, are looked for: around the
/// surface's centroid, as far as d and the surface's mean distance to it (paper §IV-B).
struct ViewSphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

struct PlannerOptions {
  PlannerName name = PlannerName::see_plus_plus;
  geometry::CameraConfig camera;  ///< by which views are chosen

  double spacing = 0.00261711877;                ///< epsilon, least distance of stored points [m]
  double view_distance = 1.0;                    ///< d, from how far surfaces are looked at [m]
  double resolution_radius = 0.017;              ///< r: what is smaller is not told apart [m]
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are dropped
  double max_incidence = 1.5707963267948966;     ///< between ray and normal, for a return [rad]
  ViewLimits limits;

  /// The settings of the named planner, complete but for seed, threads, prior surface, and the
  /// sphere of a volumetric planner that the mission does not give.
  std::variant<see::SeeConfig, skycap::SkycapConfig, volumetric::VolumetricConfig> method;

  /// The surfaces that prior data holds of the targets, made when they are asked for; may be empty.
  std::function<std::shared_ptr<const skycap::PriorSurface>()> prior_surface;

  /// Throws Error{bad_config}, "FIELD is ...; it must be ...", for the first setting that the named
  /// planner cannot work with. A sphere that is not given is taken to be fine.
  void validate() const;
};

/// What belongs to one run of a planner.
struct PlannerRun {
  std::uint64_t seed = 1;
  unsigned threads = 1;              ///< zero: all processors; does not change the plan
  std::optional<ViewSphere> sphere;  ///< of volumetric planners, where their settings give none
};

/// The planner of these options, kept to their limits. Throws Error{bad_config} if it is volumetric
/// and nothing says where its sphere is.
std::unique_ptr<Planner> make_planner(const PlannerOptions& options, const PlannerRun& run);

}  // namespace skycap::survey
