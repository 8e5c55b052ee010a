/// Shortest collision-free paths between two places: any-angle search on a grid that is refined
/// only as far as needed, then a string pulled tight, each move proven on the exact distances.
///
/// Source of the search: Nash, Koenig & Tovey, Lazy Theta*: Any-Angle Path Planning and Path Length
/// Analysis in 3D (AAAI 2010).
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "flight/space/clearance.h"

namespace skycap::flight {

struct PathOptions {
  /// Cell of the finest grid [m]: passages narrower than the clearance on both sides plus about
  /// this may be missed. Zero: a quarter of the clearance, and no less than 1/400 of the way.
  double finest_cell = 0.0;
  /// Vertices that the last round of search for a first path may expand on one grid; beyond it the
  /// goal counts as unreachable.
  std::size_t max_expansions = 200000;
  /// Grid vertices expanded, once there is a path, in search of a shorter one.
  std::size_t max_improving_expansions = 3000;
  /// A corner is cut in two (a stop more for the vehicle) only if that saves this share of the
  /// path.
  double worthwhile_saving = 0.004;

  /// Throws Error{bad_config} naming the first value that is out of its interval.
  void validate() const;
};

enum class PathStatus { found, start_not_free, goal_not_free, unreachable };

struct Path {
  PathStatus status = PathStatus::unreachable;
  std::vector<Eigen::Vector3d> points;  ///< from start to goal; empty unless found
  double length = 0.0;
  std::size_t expansions = 0;  ///< grid vertices looked at: the work done
};

double length(const std::vector<Eigen::Vector3d>& points);

/// Finds paths at one clearance. Remembers distances from search to search. Not safe to use from
/// several threads; deterministic: the result depends on the space, the options and the two places.
class PathFinder {
 public:
  /// Keeps a reference to `space`. Throws what PathOptions::validate() throws, and
  /// Error{bad_config} unless the clearance is finite and not negative.
  PathFinder(const FreeSpace& space, double clearance, const PathOptions& options = {});
  ~PathFinder();
  PathFinder(PathFinder&&) noexcept;
  PathFinder& operator=(PathFinder&&) noexcept;

  /// Every straight piece of a path found is free at the clearance. The straight line if that is
  /// free. Having found none is a normal answer; so is a start or goal that is itself not free.
  Path find(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  /// Drops what was remembered: to be called when the space has changed.
  void forget();

  double clearance() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Shortens a path whose pieces are free at `clearance` without losing that: drops points that can
/// be skipped, slides the others, cuts corners where worthwhile. Deterministic.
std::vector<Eigen::Vector3d> pull_tight(const FreeSpace& space, double clearance,
                                        std::vector<Eigen::Vector3d> points,
                                        double worthwhile_saving);

}  // namespace skycap::flight
