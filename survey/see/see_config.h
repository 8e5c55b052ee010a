/// Settings of SEE and SEE++ (see.h).
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Geometry>

#include "geometry/points/outlier_rule.h"
#include "geometry/spherical_cap/spherical_cap.h"
#include "survey/see/method_variants.h"

namespace skycap::survey::see {

/// Settings of SEE and SEE++ in a mission file. The defaults are the `paper` preset for the
/// one-metre models. A default of nullopt is derived as stated.
struct SeeConfig {
  double density = 146'000.0;                 ///< rho: required points per m^3
  double resolution_radius = 0.017;           ///< r: radius of the density test [m]
  double occlusion_search_distance = 1.0;     ///< psi: length of the occlusion test [m]
  std::size_t visibility_update_limit = 100;  ///< tau: number of views

  std::optional<int>
      core_threshold;  ///< k, including the point itself; default: ceil(4/3 pi r^3 rho)
  std::optional<double>
      spacing;  ///< epsilon: minimum distance of kept points [m]; default: rho^(-1/2)
  std::optional<double> view_distance;  ///< d [m]; default: from the camera and rho (paper §IV-B)
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are ignored

  geometry::OutlierRule outlier_rule = geometry::OutlierRule::non_core;
  std::optional<int>
      frame_neighbours;  ///< points for a frontier's frame, including the point itself; default: k
  bool free_space_normals = false;  ///< flip normals that point into the measured surface

  OffsetLine offset_line = OffsetLine::line_of_sight;
  std::optional<double>
      occlusion_radius;  ///< radius of the ball and step of the occlusion test [m]; default: r
  MarchEnd march_end = MarchEnd::search_distance;

  bool optimise_views = true;  ///< propose clear views for occluded frontiers (SEE++)
  geometry::CapConfig cap;     ///< search for the clear view (§III-B)
  ObservingDirection observing_direction = ObservingDirection::ray;
  double occluder_spacing = 0.01;  ///< spacing of the sparse cloud for the cap search [m]
  StillOccluded still_occluded = StillOccluded::discard;

  bool visibility_graph = true;     ///< weight views by the number of visible frontiers (SEE++)
  bool facing_test = false;         ///< an edge requires a frontier normal that faces the view
  bool field_of_view_test = false;  ///< an edge requires a frontier inside the image of the view
  double first_view_weight = 0.0;   ///< SEE: weight of the distance to the first view
  NearestSearch nearest = NearestSearch::exact;

  Adjustment adjustment = Adjustment::rotation;
  ScanCentroid adjustment_centroid = ScanCentroid::whole_scan;
  int max_attempts = 20;          ///< maximum number of views per frontier before it is discarded
  bool stay_on_target = false;    ///< keep the target frontier until it is resolved or discarded
  double frontier_spacing = 0.0;  ///< propose views for only one frontier within this distance [m]

  unsigned threads =
      1;  ///< threads for inserting scans; zero: all processors; does not affect results

  std::optional<double> min_height;  ///< minimum z of proposed views [m]

  /// Throws Error{bad_config} that names the first field outside its interval. Also throws if
  /// density and radius admit no frontier (k < 4, see docs/explanation/see.md).
  void validate() const;

  /// Returns the configured k, or ceil(4/3 pi r^3 rho).
  int effective_core_threshold() const;
  /// Returns half the number of points on a disc of radius r of a densely measured surface, but at
  /// least effective_core_threshold(). With this threshold, the rim of a measured surface is a
  /// frontier. With the published k, the rim is a frontier only because of noise.
  int half_disc_threshold() const;
  /// Returns the configured epsilon, or rho^(-1/2).
  double effective_spacing() const;
};

}  // namespace skycap::survey::see
