/// Uncovered surface of a survey, in connected pieces with position, area, reason and nearest view.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh.h"
#include "survey/surfel/surfel_planner.h"

namespace skycap::missions::package {

/// Connected uncovered patches with the same reason.
struct Hole {
  survey::surfel::MissingReason reason = survey::surfel::MissingReason::none;
  /// Missing area: the sum over patches of area times (1 - expected coverage) [m^2].
  double area = 0.0;
  std::size_t num_patches = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< Mean position, weighted by missing area.
  /// Unit vector; zero if the patches face in all directions.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double radius = 0.0;           ///< Maximum distance of a patch from the centre [m].
  std::size_t nearest_view = 0;  ///< Index of the view nearest to the centre; 0 without views.
  /// Distance of the nearest view from the centre [m]; 0 without views.
  double view_distance = 0.0;
};

/// Missing surface of a survey. The areas of holes, smaller pieces and rest sum to the missing
/// area, which is the area times (1 - coverage).
struct MissingSurface {
  double area = 0.0;        ///< Total area of the surface [m^2].
  double link = 0.0;        ///< Maximum gap between patches of typical size in one hole [m].
  std::vector<Hole> holes;  ///< Holes of at least `min_hole_area`, in descending order of area.
  double min_hole_area =
      0.0;                  ///< Minimum area of a listed hole: four patches of typical size [m^2].
  std::size_t smaller = 0;  ///< Number of smaller pieces.
  double smaller_area = 0.0;  ///< Missing area in smaller pieces [m^2].
  double rest = 0.0;          ///< Expected missing area in covered patches [m^2].
};

MissingSurface missing_surface(std::span<const survey::surfel::EstimatedPatch> patches,
                               std::span<const geometry::View> views);

/// Converts ground-truth samples to patches, for planners without a surface estimate. Each sample
/// becomes one covered or unobserved patch. Samples that are not visible from any admissible view
/// are unreachable. `is_visible` is empty if it was not computed.
std::vector<survey::surfel::EstimatedPatch> true_patches(const geometry::SurfaceSamples& samples,
                                                         double area,
                                                         std::span<const std::uint8_t> is_covered,
                                                         std::span<const std::uint8_t> is_visible);

/// Returns the name of a reason in files: covered, undersampled, unobserved, unreachable.
const char* to_string(survey::surfel::MissingReason reason);

}  // namespace skycap::missions::package
