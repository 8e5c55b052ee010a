/// Settings of the volumetric planners (volumetric_planner.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

namespace skycap::survey::volumetric {

enum class VolumetricMetric {
  rear_side_voxel,    ///< RSV: occupied voxels hit from behind
  rear_side_entropy,  ///< RSE: entropy in front of rear-side voxels
  occlusion_aware,    ///< OA: entropy of voxels, weighted by their visibility
  unobserved_voxel,   ///< UV: entropy of uncertain voxels, weighted by their visibility
  proximity_count,    ///< PC: shadowed voxels, weighted by proximity to the surface
  area_factor,        ///< AF: target fractions of occupied and shadowed ray ends
  average_entropy,    ///< AE: mean entropy along rays that end on a surface
};

/// Factor of the visibility weight of OA, UV and RSE for a voxel with occupancy p.
enum class VisibilityFactor {
  occupancy,  ///< p, as in the evaluation code
  freedom,    ///< 1 - p, as in the published formula
};

/// Rays ending on a surface that RSE counts.
enum class RearSideEnd {
  any,               ///< also rays arriving from a free measured voxel, as in the evaluation code
  behind_uncertain,  ///< only rays arriving from an uncertain voxel, as in the published definition
};

/// Set of rays to which the fractions of AF refer.
enum class AreaShare {
  all_rays,      ///< all rays, as in the evaluation code
  hitting_rays,  ///< only rays that hit a surface or a shadow, as in Vasquez-Gomez's code
};

struct GainSettings {
  VisibilityFactor visibility = VisibilityFactor::occupancy;
  RearSideEnd rear_side_end = RearSideEnd::any;
  AreaShare area_share = AreaShare::all_rays;
};

/// Pixels of a camera that are used to evaluate a view.
struct RayPattern {
  double rays_per_pixel = 0.1;  ///< in rows and in columns
  double window_begin = 0.25;   ///< first column and row, as fractions of the image
  double window_end = 0.75;     ///< last column and row, as fractions of the image
};

/// Selection among candidates with equal utility.
enum class TieRule {
  first,    ///< in the order of their generation
  nearest,  ///< nearest to the sensor
};

/// Settings of a volumetric planner in a mission file. With the defaults, the evaluation code
/// reproduces the figures of the SEE++ paper, as far as the paper specifies its settings.
struct VolumetricSettings {
  std::optional<std::size_t> view_limit;  ///< V; comparisons use the maximum number of views of SEE
  double candidates_per_view = 2.4;       ///< number of candidates divided by V (paper §IV-B)
  std::optional<Eigen::Vector3d>
      sphere_centre;  ///< centre of the candidate sphere, world frame [m]
  std::optional<double> sphere_radius;

  double cost_weight =
      1.0;  ///< weight of the path against the gain; both are fractions of their sums
  TieRule ties = TieRule::first;
  GainSettings gain;
  RayPattern rays;
  std::optional<double> ray_depth;  ///< length of rays [m]; default: the radius of the sphere
  std::optional<double>
      shadow_length;  ///< s: length of the shadows behind measurements [m]; default: 18 voxels
  bool downsampled = false;       ///< insert only kept points into the map instead of whole scans
  bool carve_no_returns = false;  ///< treat no-return pixels as free up to ray_depth
};

struct VolumetricConfig {
  VolumetricMetric metric = VolumetricMetric::occlusion_aware;
  double resolution = 0.017;       ///< voxel size [m]; the paper uses SEE's radius r
  double spacing = 0.00261711877;  ///< epsilon: minimum distance of kept points [m]; rho^(-1/2)
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are ignored
  std::size_t candidates = 312;
  Eigen::Vector3d sphere_centre = Eigen::Vector3d::Zero();
  double sphere_radius = 1.0;
  std::optional<double> min_height;  ///< minimum z of the candidates [m]
  std::uint64_t seed = 1;            ///< seed of the candidates
  VolumetricSettings settings;
  unsigned threads = 1;  ///< threads for evaluation; zero: all processors; does not affect results

  /// Throws Error{bad_config} that names the first field outside its interval.
  void validate() const;

  double shadow_length() const;  ///< configured length, or 18 voxels [m]
  double ray_depth() const;      ///< configured depth, or the radius of the sphere [m]
};

}  // namespace skycap::survey::volumetric
