/// The one way to plan a leg: a path from place to place, changed where returns are required, and
/// verified line by line. Survey, route, fleet and replanned views ask the same planner, so what
/// one of them reaches the others reach as well.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/paths/path.h"
#include "flight/space/clearance.h"
#include "flight/way_home/ways_home.h"

namespace skycap::flight {

/// A polyline whose lines are verified free.
struct VerifiedPath {
  std::vector<Eigen::Vector3d> points;
  double clearance = 0.0;  ///< verified lower bound over the whole path [m], see LegProof
};

/// Not safe to use from several threads, except const functions. Deterministic: the result depends
/// on the space, the options and the places alone.
class LegPlanner {
 public:
  /// Keeps a reference to `space`. Throws what PathFinder's constructor throws.
  LegPlanner(const FreeSpace& space, double clearance, const PathOptions& options);

  LegPlanner(const LegPlanner&) = delete;
  LegPlanner& operator=(const LegPlanner&) = delete;

  double clearance() const { return finder_.clearance(); }

  /// Requires of all legs a verified return from each of their points to `home`, the place above
  /// the pad.
  void require_returns(const ReturnLaw& law, const Eigen::Vector3d& home);
  /// Nothing if returns are not required.
  const std::optional<WaysHome>& returns() const { return returns_; }

  /// The shortest path that PathFinder finds. Remembered until forget().
  const Path& path(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  /// The same or, through passages too narrow for its grid, by find_path_by_sampling().
  Path wide_or_narrow_path(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  /// A path, or one near it that has the required returns.
  std::vector<Eigen::Vector3d> with_returns(std::vector<Eigen::Vector3d> path) const;

  /// Nothing if one of the lines cannot be verified.
  std::optional<VerifiedPath> verified(std::vector<Eigen::Vector3d> path) const;

  /// The verified path with the required returns; nothing if there is none.
  std::optional<VerifiedPath> leg(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  /// Shortens a path whose lines are free, see pull_tight().
  std::vector<Eigen::Vector3d> pulled_tight(std::vector<Eigen::Vector3d> path) const;

  /// Discards what is remembered: to be called when the space has changed.
  void forget();

 private:
  const FreeSpace& space_;
  double worthwhile_saving_;
  PathFinder finder_;
  std::optional<WaysHome> returns_;
  std::map<std::array<double, 6>, Path> paths_;  ///< by both ends
};

}  // namespace skycap::flight
