/// How much a view promises: the information gains of seven volumetric planners, each a sum over
/// the rays of the view through what the map knows. docs/volumetric.md writes them out.
///
/// Sources: Delmerico et al., Autonomous Robots 42 (2018), for RSV, RSE, OA, UV and PC;
/// Vasquez-Gomez et al., Robotica 33 (2015), for AF; Kriegel et al., Journal of Real-Time Image
/// Processing 10 (2015), for AE; all in the form in which the evaluation code of Delmerico et al.
/// computes them, as the SEE++ paper compares them, unless GainSettings says otherwise.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/camera.h"
#include "geometry/place/pose.h"
#include "survey/volumetric/volumetric_map.h"

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

/// Unit directions in the camera frame, column by column: x = x0, x0 + 1/k, ... up to and with
/// x1, rounded down to pixels, and likewise the rows.
std::vector<Eigen::Vector3d> ray_directions(const geometry::Camera& camera,
                                            const RayPattern& pattern);

/// The gain of a view whose rays end `depth` from it at the latest. The order of `directions`
/// matters to AF alone. Safe to call from several threads.
double information_gain(VolumetricMetric metric, const VolumetricMap& map,
                        const geometry::View& view, const std::vector<Eigen::Vector3d>& directions,
                        double depth, const GainSettings& settings = {});

/// AF's reward for a share x in [0, 1]: two cubics that rise from 0 at 0 to 1 at the wanted share
/// and fall to 0 at 1, level at all three.
double area_reward(double x, double wanted);

}  // namespace skycap::survey::volumetric
