/// What a mission may set about SEE and SEE++ (see.h).
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Geometry>

#include "geometry/directions/spherical_cap.h"
#include "geometry/points/outlier_rule.h"
#include "survey/see/readings.h"

namespace skycap::survey::see {

/// Everything about SEE and SEE++ that a mission file may set. The defaults are the paper's
/// `paper` preset on the one-metre models.
struct SeeConfig {
  double density = 146'000.0;                 ///< rho, wanted points per m^3
  double resolution_radius = 0.017;           ///< r
  double occlusion_search_distance = 1.0;     ///< psi
  std::size_t visibility_update_limit = 100;  ///< tau, in views

  std::optional<int> core_threshold;    ///< k, counting the point itself; ceil(4/3 pi r^3 rho)
  std::optional<double> spacing;        ///< epsilon, least distance of kept points; rho^(-1/2)
  std::optional<double> view_distance;  ///< d; from the camera and rho (paper §IV-B)
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are dropped first

  geometry::OutlierRule outlier_rule = geometry::OutlierRule::non_core;
  std::optional<int> frame_neighbours;  ///< points in a frontier's frame, itself included; k
  bool free_space_normals = false;      ///< flip normals that point into measured surface

  OffsetLine offset_line = OffsetLine::sight_line;
  std::optional<double> occlusion_radius;  ///< ball radius and step of the occlusion test; r
  MarchEnd march_end = MarchEnd::search_distance;

  bool optimise_views = true;  ///< propose clear views for occluded frontiers (SEE++)
  geometry::CapConfig cap;     ///< how the clear view is found (§III-B)
  ObservingDirection observing_direction = ObservingDirection::ray;
  double occluder_spacing = 0.01;  ///< spacing of the sparse cloud that the cap is found in
  StillOccluded still_occluded = StillOccluded::give_up;

  bool visibility_graph = true;     ///< weigh views by the frontiers they see (SEE++)
  bool facing_test = false;         ///< an edge needs the frontier's normal towards the view
  bool field_of_view_test = false;  ///< an edge needs the frontier inside the view's image
  double first_view_weight = 0.0;   ///< SEE: adds this times the distance to the first view
  NearestSearch nearest = NearestSearch::exact;

  Adjustment adjustment = Adjustment::rotation;
  ScanCentroid adjustment_centroid = ScanCentroid::whole_scan;
  int max_attempts = 20;          ///< views aimed at one frontier before it is given up
  bool stay_on_target = false;    ///< aim at a frontier until it is resolved or given up
  double frontier_spacing = 0.0;  ///< propose views for one frontier within this distance

  unsigned threads = 1;  ///< for inserting scans; zero: all processors. Never changes a result

  std::optional<double> least_height;  ///< lowest z of a proposed view

  /// Throws Error{bad_config} naming the first field that is out of its interval, or the density
  /// and radius if they admit no frontier (k < 4, see docs/explanation/see.md).
  void validate() const;

  /// k as given, or ceil(4/3 pi r^3 rho).
  int effective_core_threshold() const;
  /// Half of what a disc of radius r holds on a densely measured surface, and at least the above:
  /// with it the rim of a measured surface is a frontier, which by the published k it is by noise
  /// alone.
  int half_disc_threshold() const;
  /// epsilon as given, or rho^(-1/2).
  double effective_spacing() const;
};

}  // namespace skycap::survey::see
