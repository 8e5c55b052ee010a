/// A flight that is to cover a surface in few seconds, as the search for it sees it: what views
/// see, where they may be, and how long the ways between them take. Who knows it is not asked:
/// tests make up small worlds.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/pose.h"
#include "survey/skycap/view_gain.h"

namespace skycap::missions::package {

struct TourProblem {
  using View = geometry::View;

  std::span<const survey::skycap::GainField::Target> targets;
  std::function<std::vector<survey::skycap::Look>(const View&)> looks;
  /// What is seen on the straight way between two views, null being home; the same in both
  /// directions. Empty: nothing is measured on ways.
  std::function<std::vector<survey::skycap::Look>(const View* from, const View* to)> way_looks{};

  /// The view of a target from a direction (unit) and distance, as turned as limits need; nothing
  /// if they leave none.
  std::function<std::optional<View>(const Eigen::Vector3d& target, const Eigen::Vector3d& towards,
                                    double distance)>
      view_of;
  /// Whether the camera can be there and look that way. Of cheap limits, then of proven space.
  std::function<bool(const View&)> is_allowed, is_in_free_space;
  /// Whether there is a proven way home from there: asked last, of views that would be taken.
  std::function<bool(const View&)> has_way_home;

  Eigen::Vector3d home = Eigen::Vector3d::Zero();  ///< the place above the pad
  /// The straight way from view to view, until the camera looks right [s]; null stands for
  /// home, where the flight begins and ends.
  std::function<double(const View* from, const View* to)> straight_time;
  /// Whether that way is proven free; then, whether there is a proven way home from all of it,
  /// which takes far longer to find out and is asked of tours alone that may be the best.
  std::function<bool(const View*from, const View*to)> is_free, has_returns;

  double time_per_view = 0.0;  ///< at rest, or to keep views few where they are passed [s]
  /// Of flights that pass their views: what is lost in the bend at one, between the one before and
  /// the next [s]; null stands for home. Empty: every view is stopped at.
  std::function<double(const View* before, const View& at, const View* after)> bend_time{};
  double view_distance = 0.0;  ///< d: from where views are taken as a rule
};

/// A flight through views in their order, above the pad at both ends.
struct FoundTour {
  std::vector<geometry::View> views;
  double time = 0.0;     ///< rests at views included, ways that are not straight by guess [s]
  double covered = 0.0;  ///< expected share of the targets' area
};

}  // namespace skycap::missions::package
