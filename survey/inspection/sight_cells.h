/// Points that are visible from a position, prepared for cells of one metre: the search evaluates
/// millions of views.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "survey/inspection/sight_rules.h"
#include "survey/inspection/structure_cloud.h"

namespace skycap::survey::inspection {

/// Highest rule that a view of a point satisfies: 1, 2 or 3 for rules A, B and C.
struct PointSight {
  std::uint32_t packed;  ///< Index of the point times four, plus the level.
  std::uint32_t point() const { return packed >> 2; }
  std::uint32_t level() const { return packed & 3U; }
};

/// Views of a structure. Range, image and incidence are exact for each pose, with small margins.
/// Occlusion is that from the centre of the cell. Thread-safe: cells are computed when they are
/// first used, and do not depend on the order.
class SightCells {
 public:
  /// Keeps references to the arguments. `box` contains all positions of views.
  SightCells(const StructureCloud& cloud, const InspectionCamera& camera,
             const Eigen::AlignedBox3d& box);
  ~SightCells();
  SightCells(const SightCells&) = delete;
  SightCells& operator=(const SightCells&) = delete;

  /// Appends the sights of a view among the first `targets` points, ascending by point. Sights
  /// below `min_level` are skipped.
  void add_view(const Eigen::Vector3d& position, double yaw, double pitch, std::size_t targets,
                std::uint32_t min_level, std::vector<PointSight>& sights) const;

  /// Returns the level of a point from a position in the best direction, or 0.
  std::uint32_t level(const Eigen::Vector3d& position, std::uint32_t point) const;

  /// Points near a position: index times two, plus one if the point is not hidden. Ascending.
  const std::vector<std::uint32_t>& entries(const Eigen::Vector3d& position) const;

  const StructureCloud& cloud() const { return cloud_; }
  const InspectionCamera& camera() const { return camera_; }
  /// Returns true if a line from a position to a point has less than the maximum incidence. The
  /// planner's limit is 2 degrees less than that of the evaluation.
  bool is_in_incidence(const Eigen::Vector3f& line, float distance, std::uint32_t point) const;
  /// Number of cells computed so far.
  std::size_t computed() const { return computed_.load(std::memory_order_relaxed); }

 private:
  struct Cell {
    std::vector<std::uint32_t> entries;
  };
  Cell* make_cell(const Eigen::Vector3f& centre) const;

  const StructureCloud& cloud_;
  const InspectionCamera& camera_;
  Eigen::Vector3d origin_;
  Eigen::Array3i counts_;
  float min_cosine_, squared_range_, tan_half_width_, tan_half_height_;
  mutable std::vector<std::atomic<Cell*>> cells_;
  mutable std::atomic<std::size_t> computed_{0};
};

}  // namespace skycap::survey::inspection
