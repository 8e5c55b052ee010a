/// Abstract tour problem: cover a surface in minimum time. Visibility, admissibility and travel
/// times are injected so that tests can use synthetic scenes.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/pose.h"
#include "survey/surfel/view_gain.h"

namespace skycap::missions::package {

struct TourProblem {
  using View = geometry::View;

  std::span<const survey::surfel::GainField::Target> targets;
  std::function<std::vector<survey::surfel::Observation>(const View&)> observations;
  /// Removes the observations whose line of sight is blocked by surface that `observations` is too
  /// coarse for. Evaluated last because it is expensive. Empty without a finer surface.
  std::function<void(const View&, std::vector<survey::surfel::Observation>&)> remove_occluded{};
  /// Returns the observations on the straight path between two views, where null is the home
  /// position. The result must be the same in both directions. Empty if the sensor does not measure
  /// en route.
  std::function<std::vector<survey::surfel::Observation>(const View* from, const View* to)>
      leg_observations{};

  /// Returns the view of a target from a direction (unit vector) and distance [m], adjusted to the
  /// limits. Returns an empty value if the limits allow no such view.
  std::function<std::optional<View>(const Eigen::Vector3d& target, const Eigen::Vector3d& towards,
                                    double distance)>
      find_view;
  /// Return whether the camera may have this pose: by inexpensive limits, and by verified free
  /// space.
  std::function<bool(const View&)> is_allowed, is_in_free_space;
  /// Returns true if a verified return from the view exists. Evaluated last because it is
  /// expensive.
  std::function<bool(const View&)> has_return_path;

  Eigen::Vector3d home = Eigen::Vector3d::Zero();  ///< Position above the pad.
  /// Returns the duration of the straight path between two views, including the final rotation of
  /// the camera [s]. Null is the home position, where the flight starts and ends.
  std::function<double(const View* from, const View* to)> straight_time;
  /// Return whether the straight path is verified collision-free, and whether verified returns
  /// exist from all of it. The second check is much slower and is used only for candidates for the
  /// best tour.
  std::function<bool(const View*from, const View*to)> is_free, has_returns;

  /// Time at rest per view [s]. For fly-through capture, a penalty that limits the number of views.
  double time_per_view = 0.0;
  /// Returns the time lost at a view because of the bend of a fly-through path [s]. Null is the
  /// home position. Empty if the vehicle stops at every view.
  std::function<double(const View* before, const View& at, const View* after)> bend_time{};
  double view_distance = 0.0;  ///< Default distance d of views from the surface [m].
};

/// Tour through views in order. It starts and ends above the pad.
struct FoundTour {
  std::vector<geometry::View> views;
  /// Duration including rest times at views; estimated for paths that are not straight [s].
  double time = 0.0;
  double covered = 0.0;  ///< Expected covered fraction of the targets' area.
};

}  // namespace skycap::missions::package
