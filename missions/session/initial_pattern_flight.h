/// Start of a survey: a given view, or an initial pattern outside the unknown box, which requires
/// no knowledge of its contents.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/pose/platform.h"
#include "geometry/pose/pose.h"

namespace skycap::missions::session {

/// Initial pattern of a flown survey, before the first view is planned. Its path is outside the
/// unknown box.
enum class InitialPattern {
  none,
  orbit,   ///< Orbits around the box.
  strips,  ///< Parallel strips above the box.
};

struct StartOptions {
  std::optional<geometry::View> view;  ///< First view; empty if it is not specified.
  InitialPattern initial_pattern =
      InitialPattern::none;  ///< Initial pattern of a mission with a vehicle.

  // Parameters of the initial pattern.
  Eigen::AlignedBox3d box;  ///< The unknown box.
  double clearance = 0.0;   ///< [m]
  double min_height =
      0.0;  ///< Height of the lower end of the scene, or minimum height of views [m].
  double view_distance = 1.0;                   ///< [m]
  std::optional<geometry::ScannerMount> mount;  ///< Mount of a scanner on a vehicle.
  bool sees_lines = false;                      ///< Single-line LiDAR.
};

/// Returns the default pattern: orbits, or strips if the box is wider than twice its height.
InitialPattern default_initial_pattern(const Eigen::AlignedBox3d& box);

/// Returns the corners of the initial pattern in flight order, starting with the first view.
/// Returns an empty list without a pattern. `seed` selects the start corner.
std::vector<geometry::View> initial_pattern_views(const StartOptions& start, std::uint64_t seed);

}  // namespace skycap::missions::session
