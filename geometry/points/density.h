/// Classification of the points of a growing cloud by local density. It shows where the surface is
/// measured densely enough and where the boundary of the measured surface is.
///
/// A point is *core* if at least k points, including the point itself, lie within r of it. A point
/// that is not core is a *frontier* if a core point and another non-core point lie within r of it.
/// All other points are *outliers* (SEE++ §III). With k < 4 no frontier can exist: a non-core point
/// would need two others within r and would therefore be core.
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
  double radius = 0.017;    ///< r: neighbourhood radius [m]
  int core_threshold = 4;   ///< k: minimum neighbours of a core point, including itself
  double spacing = 0.0026;  ///< epsilon [m]: points closer than this to a kept point are dropped
  OutlierRule rule = OutlierRule::non_core;
};

/// Changes made by an update. All lists are in ascending order.
struct DensityUpdate {
  std::uint32_t first_new = 0;                ///< new points: [first_new, cloud().size())
  std::vector<std::uint32_t> new_frontiers;   ///< points that became frontiers
  std::vector<std::uint32_t> lost_frontiers;  ///< points that are not frontiers any more
};

/// Cloud with a minimum point spacing and a label for each point.
///
/// With OutlierRule::non_core, the labels after every update equal those computed from scratch. The
/// cost of an update depends on the new points, not on the size of the cloud. Core points never
/// change; only other points with new neighbours are relabelled.
class DensityMap {
 public:
  explicit DensityMap(const DensityConfig& config);

  const DensityConfig& config() const { return config_; }
  const PointCloud& cloud() const { return cloud_; }
  /// Moves the cloud out of the map. No other member function may be called afterwards.
  PointCloud take_cloud() { return std::move(cloud_); }
  const SpatialIndex& index() const { return index_; }
  PointLabel label(std::uint32_t point) const { return labels_[point]; }
  const std::vector<PointLabel>& labels() const { return labels_; }

  /// Inserts, in order, the `points` that are farther than the spacing from every kept point. The
  /// kept points are attributed to scan `view`. relabel() must follow. The result depends neither
  /// on `threads` (zero: all processors) nor on `image`, which only speeds up the search for
  /// neighbours.
  void insert(std::span<const Eigen::Vector3f> points, std::uint32_t view, unsigned threads = 1,
              const ImagePixels& image = {});
  /// Updates the labels after all insertions since the last call. The result does not depend on
  /// `threads`.
  DensityUpdate relabel(unsigned threads = 1);

  /// Labels a frontier as an outlier until a new point is inserted within r of it.
  void discard(std::uint32_t frontier);

 private:
  struct NonCore {
    std::uint32_t point;
    std::uint32_t neighbours;  // number of points within r, including the point itself
  };

  std::vector<std::uint32_t> promote_dense_points(std::uint32_t first_new, unsigned threads);
  std::uint32_t count_neighbours(std::uint32_t point) const;
  std::vector<std::uint32_t> points_to_relabel(const std::vector<std::uint32_t>& promoted) const;
  bool is_frontier(std::uint32_t point) const;

  DensityConfig config_;
  PointCloud cloud_;
  SpatialIndex index_;
  SpacedPoints spaced_;  // the same points in a finer grid, for spacing queries
  std::vector<PointLabel> labels_;
  std::vector<NonCore> non_core_;  // ascending by point
  std::vector<std::uint8_t> discarded_;
  std::uint32_t labelled_ = 0;  // number of labelled points
};

}  // namespace skycap::geometry
