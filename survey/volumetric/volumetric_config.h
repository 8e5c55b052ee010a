/// What a mission may set about a volumetric planner (volumetric_planner.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

namespace skycap::survey::volumetric {

enum class VolumetricMetric {
  rear_side_voxel,    ///< RSV: occupied voxels met from behind
  rear_side_entropy,  ///< RSE: entropy of what lies before such voxels
  occlusion_aware,    ///< OA: entropy of voxels, weighted by how likely they are visible
  unobserved_voxel,   ///< UV: the same, of uncertain voxels only
  proximity_count,    ///< PC: shadowed voxels, more the nearer they are to the surface
  area_factor,        ///< AF: wanted shares of occupied and shadowed ends of rays
  average_entropy,    ///< AE: mean entropy along rays that end on a surface
};

/// By what the visibility weight of OA, UV and RSE is multiplied at a voxel of occupancy p.
enum class VisibilityFactor {
  occupancy,  ///< p: the evaluation code
  freedom,    ///< 1 - p: the published formula
};

/// Which rays that end on a surface RSE counts.
enum class RearSideEnd {
  any,               ///< those that come from a measured-free voxel too: the evaluation code
  behind_uncertain,  ///< only those that come from an uncertain voxel: the published definition
};

/// What AF takes shares of.
enum class AreaShare {
  all_rays,      ///< the evaluation code
  hitting_rays,  ///< only rays that meet a surface or a shadow: Vasquez-Gomez' own code
};

struct GainSettings {
  VisibilityFactor visibility = VisibilityFactor::occupancy;
  RearSideEnd rear_side_end = RearSideEnd::any;
  AreaShare area_share = AreaShare::all_rays;
};

/// Which of a camera's pixels a view is judged by.
struct RayPattern {
  double rays_per_pixel = 0.1;  ///< in a row and in a column
  double window_begin = 0.25;   ///< first column and row, as shares of the image
  double window_end = 0.75;     ///< last column and row
};

/// Which of equally useful candidates is taken.
enum class TieRule {
  first,    ///< in the order in which they were drawn
  nearest,  ///< to the sensor
};

/// What a mission file may set about a volumetric planner. The defaults are those with which the
/// evaluation code gives the SEE++ paper's figures, as far as the paper lets one tell.
struct VolumetricSettings {
  std::optional<std::size_t> view_limit;  ///< V; a comparison takes SEE's largest number of views
  double candidates_per_view = 2.4;       ///< candidates are V times this (paper §IV-B)
  std::optional<Eigen::Vector3d> sphere_centre;  ///< of the candidates; world frame
  std::optional<double> sphere_radius;

  double cost_weight = 1.0;  ///< of the way, against the gain; both are shares of their sums
  TieRule ties = TieRule::first;
  GainSettings gain;
  RayPattern rays;
  std::optional<double> ray_depth;      ///< where rays end; the sphere's radius
  std::optional<double> shadow_length;  ///< s, of the shadows behind measurements; 18 voxels
  bool thinned = false;           ///< the map takes only points that are kept, not whole scans
  bool carve_no_returns = false;  ///< the map takes pixels without return as free up to ray_depth
};

struct VolumetricConfig {
  VolumetricMetric metric = VolumetricMetric::occlusion_aware;
  double resolution = 0.017;       ///< width of a voxel; the paper takes SEE's radius r
  double spacing = 0.00261711877;  ///< epsilon, least distance of kept points; rho^(-1/2)
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are dropped first
  std::size_t candidates = 312;
  Eigen::Vector3d sphere_centre = Eigen::Vector3d::Zero();
  double sphere_radius = 1.0;
  std::optional<double> least_height;  ///< no candidate is lower
  std::uint64_t seed = 1;              ///< of the candidates
  VolumetricSettings settings;
  unsigned threads = 1;  ///< for scoring; zero: all processors. Never changes a result

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;

  double shadow_length() const;  ///< as given, or 18 voxels
  double ray_depth() const;      ///< as given, or the sphere's radius
};

}  // namespace skycap::survey::volumetric
