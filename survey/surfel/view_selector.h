/// View selection. Generates candidate views of the most valuable targets, selects a batch of
/// complementary views, and plans a short tour through them. The first view of the tour is flown.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/pose.h"
#include "survey/surfel/view_gain.h"
#include "survey/view_limits.h"

namespace skycap::survey::surfel {

struct ViewSelectorSettings {
  double view_distance = 2.0;  ///< d: distance of views from their targets [m]
  /// Distances of candidates from their targets, as fractions of `view_distance` in descending
  /// order. The first admissible distance is used.
  std::vector<double> distances = {1.0};
  double view_price = 4.0;  ///< fixed cost of a view, in metres of path
  int clusters = 40;        ///< number of target clusters for which candidates are generated
  int cells_across = 7;     ///< number of cluster cells along the longest side of all targets
  int global_directions =
      40;               ///< number of candidates distributed evenly around all uncovered surface
  int refinements = 3;  ///< number of rounds in which the best candidates are moved
  int batch = 5;        ///< number of views planned ahead, at most 6; 1: only the next best view
  double prediction_yield = 1.0;  ///< yield of predicted gains (PredictionYield)
  unsigned threads = 1;           ///< zero: all processors
  std::stop_token stop{};         ///< a stop request lets choose_view() throw Interrupted
  /// Path length between en-route frames [m]; zero: no en-route frames.
  double frame_spacing = 0.0;
  bool counts_en_route = false, sees_lines = false;  ///< see SurfelConfig
};

/// Returns `count` views on the straight path between two views, without its ends. The camera
/// rotates uniformly in yaw and pitch.
std::vector<geometry::View> views_between(const geometry::View& from, const geometry::View& to,
                                          std::size_t count);

struct Choice {
  geometry::View view;
  double gain;  ///< expected newly covered area of this view [m^2]
  std::vector<VisibleTarget>
      with_leg;  ///< targets in sight of the view and of the straight path to it
  /// Expected gain of the best reachable view, for stop rules. Predicted surface is weighted by
  /// `prediction_yield`. With `counts_en_route`, the path to the view is included.
  double best_gain;
  /// Visibility of each target of the field: the probability that the best of several good views at
  /// different positions sees it, if it exists. Targets that none of these views sees are hidden.
  std::vector<float> chances;
};

/// Cached gains and sights by view position and direction. After a rejection, the next view is
/// selected from nearly the same candidates, and only new ones are evaluated. Valid for one field,
/// one present view and constant settings, except for `prediction_yield`.
struct ViewGainCache {
  using Key = std::array<double, 6>;
  std::map<Key, Gain> gains;
  std::map<Key, std::vector<VisibleTarget>>
      pool;  ///< sights of the last selection, including the paths to the views
};

/// Returns whether the sensor can be at a view. Must be thread-safe.
using Admission = std::function<bool(const geometry::View&)>;

/// Returns the combined sights of a view and the frames on the straight path to it, ascending by
/// target. The covered fraction is that of any of them. A few frames represent all; without frames,
/// the result is that of the view alone.
std::vector<VisibleTarget> visible_with_leg(const GainField& field, const geometry::View& from,
                                            const geometry::View& to, double frame_spacing);

/// Returns the sights of a sensor that measures only vertical lines, to the left of its nose and
/// perpendicular to its view direction. The view itself shows nothing. The path shows the surface
/// that the lines sweep at the view distance, by lateral movement and by rotation.
std::vector<VisibleTarget> visible_along_lines(const GainField& field, const geometry::View& from,
                                               const geometry::View& to, double frame_spacing,
                                               double view_distance);

/// Returns the next view from `present`, or nullopt if no admissible view has a gain. Views farther
/// away than `max_path_length` [m] are skipped. With en-route frames, the best single views are
/// ranked in the batch by the combined coverage of view and straight path. The result is
/// independent of the number of threads and of the cached values.
std::optional<Choice> choose_view(const GainField& field, const ViewLimits& limits,
                                  const Admission& admits, const geometry::View& present,
                                  double max_path_length, const ViewSelectorSettings& settings,
                                  ViewGainCache& cache);

}  // namespace skycap::survey::surfel
