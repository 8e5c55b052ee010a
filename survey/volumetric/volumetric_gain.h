/// Information gains of the seven volumetric planners. Each gain is a sum over the rays of a view
/// through the map. docs/explanation/volumetric.md contains the formulas.
///
/// Sources: Delmerico et al., Autonomous Robots 42 (2018), for RSV, RSE, OA, UV and PC;
/// Vasquez-Gomez et al., Robotica 33 (2015), for AF; Kriegel et al., Journal of Real-Time Image
/// Processing 10 (2015), for AE. Unless GainSettings selects otherwise, all gains are those of the
/// evaluation code of Delmerico et al., which the SEE++ paper uses.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/pose/camera.h"
#include "geometry/pose/pose.h"
#include "survey/volumetric/volumetric_config.h"
#include "survey/volumetric/volumetric_map.h"

namespace skycap::survey::volumetric {

/// Returns unit directions in the camera frame, column by column. Columns are x0, x0 + 1/k, ...,
/// x1, rounded down to pixels; rows likewise.
std::vector<Eigen::Vector3d> ray_directions(const geometry::Camera& camera,
                                            const RayPattern& pattern);

/// Returns the gain of a view whose rays have the maximum length `depth` [m]. The order of
/// `directions` affects only AF. Thread-safe.
double information_gain(VolumetricMetric metric, const VolumetricMap& map,
                        const geometry::View& view, const std::vector<Eigen::Vector3d>& directions,
                        double depth, const GainSettings& settings = {});

/// Returns the reward of AF for a fraction x in [0, 1]. It consists of two cubics: from 0 at 0 to 1
/// at the target fraction, and to 0 at 1, with zero slope at all three.
double area_reward(double x, double target_area);

}  // namespace skycap::survey::volumetric
