/// Which points of a growing cloud have been measured densely enough, and where the boundary of
/// the measured surface runs.
///
/// A point is *core* if at least k points, itself included, lie within r of it. A point that is not
/// core is a *frontier* if it has both a core and another non-core point within r, and an *outlier*
/// otherwise (SEE++ §III). With k < 4 no frontier can exist: a non-core point would need two others
/// within r and so be core itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/outlier_rule.h"
#include "geometry/points/point_cloud.h"
#include "geometry/points/scan.h"
#include "geometry/points/spaced_points.h"
#include "geometry/points/spatial_index.h"

namespace skycap::geometry {

enum class PointLabel : std::uint8_t { core, frontier, outlier };

struct DensityConfig {
  double radius = 0.017;    ///< r
  int core_threshold = 4;   ///< k, counting the point itself
  double spacing = 0.0026;  ///< epsilon: points nearer than this to a kept one are not kept
  OutlierRule rule = OutlierRule::non_core;
};

/// What an update changed. All lists ascend.
struct DensityUpdate {
  std::uint32_t first_new = 0;                ///< new points are [first_new, cloud().size())
  std::vector<std::uint32_t> new_frontiers;   ///< became frontiers
  std::vector<std::uint32_t> lost_frontiers;  ///< were frontiers before
};

/// A cloud kept at a least spacing, with the label of each point.
///
/// After every update the labels are those that a computation from scratch would give (with
/// OutlierRule::non_core), at a cost that depends on what is new, not on the cloud's size:
/// core points stay core for ever, and only the others with new neighbours are looked at again.
class DensityMap {
 public:
  explicit DensityMap(const DensityConfig& config);

  const DensityConfig& config() const { return config_; }
  const PointCloud& cloud() const { return cloud_; }
  /// Hands the points over; nothing may be asked afterwards.
  PointCloud release_cloud() { return std::move(cloud_); }
  const SpatialIndex& index() const { return index_; }
  PointLabel label(std::uint32_t point) const { return labels_[point]; }
  const std::vector<PointLabel>& labels() const { return labels_; }

  /// Keeps those of `points`, in order, that are farther than the spacing from every point kept
  /// before; they are said to come from scan `view`. relabel() must follow. What is kept depends
  /// neither on `threads` (zero: all processors) nor on `image`, which says where neighbours are.
  void insert(std::span<const Eigen::Vector3f> points, std::uint32_t view, unsigned threads = 1,
              const ImagePixels& image = {});
  /// Brings the labels up to date with all insertions since the last call. They do not depend on
  /// `threads`, either.
  DensityUpdate relabel(unsigned threads = 1);

  /// Makes a frontier an outlier until a new point arrives within r of it.
  void give_up(std::uint32_t frontier);

 private:
  struct NonCore {
    std::uint32_t point;
    std::uint32_t neighbours;  // within r, itself included
  };

  std::vector<std::uint32_t> promote_dense_points(std::uint32_t first_new, unsigned threads);
  std::uint32_t neighbours_of(std::uint32_t point) const;
  std::vector<std::uint32_t> points_to_relabel(const std::vector<std::uint32_t>& promoted) const;
  bool is_frontier(std::uint32_t point) const;

  DensityConfig config_;
  PointCloud cloud_;
  SpatialIndex index_;
  SpacedPoints spaced_;  // the same points in smaller cells, for the spacing
  std::vector<PointLabel> labels_;
  std::vector<NonCore> non_core_;  // ascending by point
  std::vector<std::uint8_t> given_up_;
  std::uint32_t labelled_ = 0;  // points that have a label
};

}  // namespace skycap::geometry
