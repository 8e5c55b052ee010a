/// Measures of the protocol of GenNBV and its successors, for comparison with published results:
/// grid coverage, area under the curve over N views, and Chamfer distance. Grid coverage counts
/// large cells and is a far looser measure than the coverage of Skycap.
///
/// Source: Chen et al., "GenNBV: Generalizable Next-Best-View Policy for Active 3D Reconstruction",
/// CVPR 2024.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace skycap::missions::batch {

/// Numbers of views of the area under the curve.
inline constexpr std::array<std::size_t, 5> auc_views{5, 10, 15, 20, 30};

/// Returns the mean over the first `views` views of the coverage after each view. A survey that
/// ends earlier keeps its last value. Requires at least one view.
double compute_auc(std::span<const double> coverage_after, std::size_t views);

/// Covered fractions of the cells of a grid over the model's box.
struct GridCoverage {
  double all = 0.0;
  double visible = 0.0;  ///< of the cells that contain a visible sample
};

/// Divides the bounding box of the surface samples into 20 x 20 x 20 cells. A cell counts if it
/// contains a sample, and is covered if it contains a measured point. `is_visible` has an entry per
/// sample.
GridCoverage compute_grid_coverage(std::span<const Eigen::Vector3f> cloud,
                                   std::span<const Eigen::Vector3f> samples,
                                   std::span<const std::uint8_t> is_visible);

/// Returns the Chamfer distance [m]: the mean of both means of the distances from each point of one
/// set to the nearest of the other. The points of both sets are rounded to 1 cm and counted once.
/// Zero if a set is empty.
double compute_chamfer_distance(std::span<const Eigen::Vector3f> cloud,
                                std::span<const Eigen::Vector3f> samples);

}  // namespace skycap::missions::batch
