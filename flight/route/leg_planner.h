/// Leg planner shared by survey, route, fleet and replanning, so that all of them reach the same
/// positions. Paths are adapted where returns are required and verified line by line.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/paths/path.h"
#include "flight/rtl/return_paths.h"

namespace skycap::flight {

/// Polyline whose lines are verified collision-free.
struct VerifiedPath {
  std::vector<Eigen::Vector3d> points;
  double clearance = 0.0;  ///< Verified lower bound over the whole path [m], see LegVerification.
};

/// Plans verified legs. Not thread-safe, except for const functions. Deterministic: the result
/// depends only on the space, the options and the two end points.
class LegPlanner {
 public:
  /// Keeps a reference to `space`. Throws the same errors as the PathFinder constructor.
  LegPlanner(const FreeSpace& space, double clearance, const PathOptions& options);

  LegPlanner(const LegPlanner&) = delete;
  LegPlanner& operator=(const LegPlanner&) = delete;

  double clearance() const { return finder_.clearance(); }

  /// Requires a verified return from every point of every leg to `home`, the position above the
  /// pad.
  void require_returns(const RtlProfile& rtl_profile, const Eigen::Vector3d& home);
  /// Returns the returns planner, or std::nullopt if returns are not required.
  const std::optional<ReturnPaths>& returns() const { return returns_; }

  /// Returns the shortest path found by PathFinder. Paths are cached until forget().
  const Path& path(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  /// Returns path() or, if its grid is too coarse for a narrow passage, the result of
  /// find_path_by_sampling().
  Path wide_or_narrow_path(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  /// Returns `path`, or a nearby path that has the required returns.
  std::vector<Eigen::Vector3d> with_returns(std::vector<Eigen::Vector3d> path) const;

  /// Returns the verified path, or std::nullopt if one of its lines cannot be verified.
  std::optional<VerifiedPath> verified(std::vector<Eigen::Vector3d> path) const;

  /// Returns the verified path with the required returns, or std::nullopt if none exists.
  std::optional<VerifiedPath> leg(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  /// Returns a shortened version of a free path, see pull_tight().
  std::vector<Eigen::Vector3d> pulled_tight(std::vector<Eigen::Vector3d> path) const;

  /// Clears the caches. Must be called after the space has changed.
  void forget();

 private:
  const FreeSpace& space_;
  double worthwhile_saving_;
  PathFinder finder_;
  std::optional<ReturnPaths> returns_;
  /// Cached paths, keyed by start and goal coordinates.
  std::map<std::array<double, 6>, Path> paths_;
};

}  // namespace skycap::flight
