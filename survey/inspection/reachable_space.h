/// Distance field around a structure, and the part of space in which a flight may be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "survey/inspection/structure_cloud.h"

namespace skycap::survey::inspection {

/// Returns the distance of a position from the nearest obstacle, at most `up_to` [m]. Must be
/// thread-safe.
using ObstacleDistance = std::function<double(const Eigen::Vector3d& position, double up_to)>;
/// Returns true if the vehicle may be at a position. Must be thread-safe.
using FreePosition = std::function<bool(const Eigen::Vector3d& position)>;

struct SpaceOptions {
  Eigen::AlignedBox3d box;    ///< Region of the flight [m].
  double clearance = 3.0;     ///< [m]
  double max_distance = 5.0;  ///< Larger distances are stored as this value [m].
  double min_height = -std::numeric_limits<double>::infinity();  ///< z [m]
  double max_height = std::numeric_limits<double>::infinity();   ///< z [m]
  ObstacleDistance distance;  ///< Null: distance from the points of the structure.
  FreePosition is_free;       ///< Null: at least the clearance from all obstacles.
  unsigned threads = 1;       ///< Zero: all processors. Does not affect the result.
};

/// Distances at the nodes of a grid, interpolated in between. The field adds its own error to the
/// required clearance. Only space that is connected to the outside at the clearance is reachable,
/// so that hollow structures are not entered. Immutable and thread-safe.
class ReachableSpace {
 public:
  /// Throws Error{bad_geometry} if no position is reachable.
  ReachableSpace(const StructureCloud& cloud, const SpaceOptions& options);

  /// Returns the interpolated distance [m]. Positions outside of the box have a distance of 0.
  double distance(const Eigen::Vector3d& position) const;
  /// Distance that positions must have in the field [m].
  double required_distance() const { return required_; }
  double min_height() const { return options_.min_height; }
  double max_height() const { return options_.max_height; }
  const Eigen::AlignedBox3d& box() const { return options_.box; }

  /// Returns true if the nearest node of the coarse grid is reachable and the position keeps the
  /// required distance and the limits of height.
  bool is_reachable(const Eigen::Vector3d& position) const;
  /// Returns true if positions along a line keep the required distance.
  bool is_clear(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

  /// Coarse grid of reachable nodes. Its spacing is at most the clearance.
  std::size_t nodes() const { return reachable_.size(); }
  bool is_reachable_node(std::size_t node) const { return reachable_[node] != 0; }
  Eigen::Vector3d node_position(std::size_t node) const;
  const Eigen::Array3i& node_counts() const { return node_counts_; }
  double node_spacing() const { return node_spacing_; }
  /// Returns the reachable node nearest to a position within two cells, if any.
  std::optional<std::size_t> reachable_node_near(const Eigen::Vector3d& position) const;

 private:
  void compute_from_points(const StructureCloud& cloud);
  void compute_from_obstacles();
  void flood();
  std::size_t field_index(int x, int y, int z) const;
  std::size_t node_index(const Eigen::Array3i& node) const;
  Eigen::Array3i nearest_node(const Eigen::Vector3d& position) const;

  SpaceOptions options_;
  double spacing_ = 0.5;       // of the field [m]
  double node_spacing_ = 1.0;  // of the coarse grid [m]
  double required_ = 0.0;
  Eigen::Array3i counts_, node_counts_;
  std::vector<float> field_;
  std::vector<std::uint8_t> reachable_;
};

}  // namespace skycap::survey::inspection
