/// Multi-view matcher that measures the part of a surface that can be reconstructed from simulated
/// photos.
///
/// Plane sweep (Collins, A space-sweep approach to true multi-image matching, 1996) at samples of
/// the surface. The matcher uses the ground truth normals and searches only near the ground truth
/// depth, so it is optimistic. In a comparison with an independent program (MVE), both agreed on
/// 95.5% of the samples of five plans.
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

/// Surface sample whose depth is searched.
struct MatchSample {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< Position in the world frame [m].
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Outward unit normal.
};

struct MatchOptions {
  std::size_t references =
      6;  ///< Measured photos per sample, in ascending order of distance / cosine.
  std::size_t partners = 6;  ///< Photos with which each reference photo is compared.
  double max_incidence =
      75.0 * geometry::radians_per_degree;  ///< Maximum angle of incidence [rad].
  double ideal_parallax =
      15.0 * geometry::radians_per_degree;  ///< Parallax of preferred partners [rad].
  double min_parallax =
      3.0 * geometry::radians_per_degree;  ///< Minimum parallax of partners [rad].
  double max_parallax =
      65.0 * geometry::radians_per_degree;  ///< Maximum parallax of partners [rad].
  double max_scale = 2.5;  ///< Maximum ratio of the distances of a photo and its partner.
  int patch_radius = 3;    ///< Radius r of a patch with 2 r + 1 pixels on each side.
  double search = 12.0;    ///< Search range on both sides of the ground truth depth [GSD].
  double tolerance = 2.0;  ///< Maximum error of a correct depth [GSD].
  double min_score = 0.7;  ///< Minimum mean of the three best normalised cross-correlations.
  unsigned threads = 0;    ///< Zero: all processors. Does not affect the result.
};

/// Returns for each sample the number of photos in which its depth is found within the tolerance,
/// at most `references`. `images` are the images of `views`, taken with `camera`. `is_visible`
/// returns true if the line of sight from a view to a sample is free.
std::vector<std::uint8_t> right_depths(
    std::span<const MatchSample> samples, std::span<const GreyImage> images,
    std::span<const geometry::View> views, const geometry::PhotoCamera& camera,
    const std::function<bool(const geometry::View& view, const MatchSample& sample)>& is_visible,
    const MatchOptions& options = {});

/// Returns the fraction of samples with at least `depths` correct depths.
double completeness(std::span<const std::uint8_t> right, std::uint8_t depths);

}  // namespace skycap::sim
