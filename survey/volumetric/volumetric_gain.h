/// How much a view promises: the information gains of seven volumetric planners, each a sum over
/// the rays of the view through what the map knows. docs/explanation/volumetric.md writes them out.
///
/// Sources: Delmerico et al., Autonomous Robots 42 (2018), for RSV, RSE, OA, UV and PC;
/// Vasquez-Gomez et al., Robotica 33 (2015), for AF; Kriegel et al., Journal of Real-Time Image
/// Processing 10 (2015), for AE; all in the form in which the evaluation code of Delmerico et al.
/// computes them, as the SEE++ paper compares them, unless GainSettings says otherwise.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/place/camera.h"
#include "geometry/place/pose.h"
#include "survey/volumetric/volumetric_config.h"
#include "survey/volumetric/volumetric_map.h"

namespace skycap::survey::volumetric {

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
