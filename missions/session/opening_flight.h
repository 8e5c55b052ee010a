/// How a survey begins: with a given view, or with a way outside of the unknown box, so that
/// nothing has to be known of what is in it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/place/platform.h"
#include "geometry/place/pose.h"

namespace skycap::missions::session {

/// What a flown survey begins with, before any view is planned: ways outside of the unknown box.
enum class Opening {
  none,
  orbit,   ///< round the box
  strips,  ///< to and fro over it
};

struct StartOptions {
  std::optional<geometry::View> view;  ///< the first view; nothing: left open
  Opening opening = Opening::none;     ///< of a mission that is flown

  // What the opening is laid out by.
  Eigen::AlignedBox3d box;     ///< the unknown box
  double clearance = 0.0;      ///< [m]
  double lowest = 0.0;         ///< z of the foot of the scene, or the least z of views
  double view_distance = 1.0;  ///< [m]
  std::optional<geometry::ScannerMount> mount;  ///< of a scanner that is flown
  bool sees_lines = false;                      ///< a scanner of a single line
};

/// Round a box, or over it if it is wider than twice its height.
Opening usual_opening(const Eigen::AlignedBox3d& box);

/// The corners of the opening in the order flown; the first is where the survey begins. Empty
/// without one. The seed says at which corner it begins.
std::vector<geometry::View> opening_views(const StartOptions& start, std::uint64_t seed);

}  // namespace skycap::missions::session
