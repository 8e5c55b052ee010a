/// A multi-view matcher that measures how much of a surface simulated photos reconstruct.
///
/// Plane sweep (Collins, A space-sweep approach to true multi-image matching, 1996) at samples of
/// the surface. It is told the true normals and searches only near the true depth, so it is
/// optimistic; it was compared with an independent program (MVE), with which it agreed on 95.5% of
/// the samples of five plans.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/angle.h"
#include "geometry/pose/photo_camera.h"
#include "geometry/pose/pose.h"
#include "sim/photos/simulated_photo.h"

namespace skycap::sim {

/// A sample of the surface whose depth is searched.
struct MatchSample {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< world frame
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, to the outside
};

struct MatchOptions {
  std::size_t references =
      6;                     ///< photos of a sample whose depth is measured, nearest head-on first
  std::size_t partners = 6;  ///< photos that each of them is compared with
  double max_incidence = 75.0 * geometry::radians_per_degree;   ///< [rad]
  double ideal_parallax = 15.0 * geometry::radians_per_degree;  ///< partners nearest to it first
  double min_parallax = 3.0 * geometry::radians_per_degree;     ///< [rad]
  double max_parallax = 65.0 * geometry::radians_per_degree;    ///< [rad]
  double max_scale = 2.5;  ///< between the distances of a photo and its partner
  int patch_radius = 3;    ///< a patch has 2 r + 1 pixels on each side
  double search = 12.0;    ///< depths to either side of the true one [GSD]
  double tolerance = 2.0;  ///< error of a right depth [GSD]
  double min_score = 0.7;  ///< mean of the three best normalised cross-correlations
  unsigned threads = 0;    ///< zero: all processors; does not change the result
};

/// For each sample the number of photos in which its depth is found within the tolerance, at most
/// `references`. `images` are those of `views`, taken with `camera`. `is_visible` tells whether a
/// photo's line of sight to a sample is free.
std::vector<std::uint8_t> right_depths(
    std::span<const MatchSample> samples, std::span<const GreyImage> images,
    std::span<const geometry::View> views, const geometry::PhotoCamera& camera,
    const std::function<bool(const geometry::View& view, const MatchSample& sample)>& is_visible,
    const MatchOptions& options = {});

/// Fraction of samples with at least `depths` right depths.
double completeness(std::span<const std::uint8_t> right, std::uint8_t depths);

}  // namespace skycap::sim
