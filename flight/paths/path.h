/// Shortest collision-free paths between two positions. An any-angle search runs on a grid that is
/// refined as needed, and its result is pulled tight. Every line is verified with exact distances.
///
/// Source of the search: Nash, Koenig & Tovey, Lazy Theta*: Any-Angle Path Planning and Path Length
/// Analysis in 3D (AAAI 2010).
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"

namespace skycap::flight {

struct PathOptions {
  /// Cell size of the finest grid [m]. Passages narrower than twice the clearance plus about this
  /// size may be missed. 0: a quarter of the clearance, but at least 1/400 of the path.
  double finest_cell = 0.0;
  /// Maximum number of grid vertices that the last search round for a first path may expand. Beyond
  /// it, the goal counts as unreachable.
  std::size_t max_expansions = 200000;
  /// Maximum number of grid vertices expanded in search of a shorter path.
  std::size_t max_improving_expansions = 3000;
  /// Minimum relative saving for which a corner is split in two, because each corner is a stop.
  double worthwhile_saving = 0.004;

  /// Throws Error{bad_config} naming the first value outside its interval.
  void validate() const;
};

enum class PathStatus { found, start_not_free, goal_not_free, unreachable };

struct Path {
  PathStatus status = PathStatus::unreachable;
  std::vector<Eigen::Vector3d> points;  ///< Points from start to goal. Empty unless found.
  double length = 0.0;
  std::size_t expansions = 0;  ///< Number of expanded grid vertices, as a measure of effort.
};

double length(const std::vector<Eigen::Vector3d>& points);

/// Finds paths at one clearance and caches distances between searches. Not thread-safe.
/// Deterministic: the result depends only on the space, the options and the two positions.
class PathFinder {
 public:
  /// Keeps a reference to `space`. Throws the same errors as PathOptions::validate(), and
  /// Error{bad_config} unless the clearance is finite and not negative.
  PathFinder(const FreeSpace& space, double clearance, const PathOptions& options = {});
  ~PathFinder();
  PathFinder(PathFinder&&) noexcept;
  PathFinder& operator=(PathFinder&&) noexcept;

  /// Returns a path whose lines are all free at the clearance. That is the straight line if it is
  /// free. A missing path, or a start or goal that is not free, is a regular result and not an
  /// error.
  Path find(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  /// Clears the cache. Must be called after the space has changed.
  void forget();

  double clearance() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Shortens a path whose lines are free at `clearance` and keeps them free. Removes redundant
/// points, moves the others and cuts corners where worthwhile. Deterministic.
std::vector<Eigen::Vector3d> pull_tight(const FreeSpace& space, double clearance,
                                        std::vector<Eigen::Vector3d> points,
                                        double worthwhile_saving);

}  // namespace skycap::flight
