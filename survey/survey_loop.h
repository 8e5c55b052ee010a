/// Survey loop that alternates between planner and sensor until the planner ends the survey or a
/// limit is reached.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "geometry/points/scan.h"
#include "geometry/pose/pose.h"
#include "survey/planner.h"
#include "survey/survey_limits.h"

namespace skycap::survey {

/// Scans taken en route to a view.
struct ScansEnRoute {
  std::vector<geometry::View> views;  ///< views of the scans, in order
  std::size_t returns = 0;            ///< total number of points
};

/// View of a survey with its measurement and planning results.
struct SurveyedView {
  geometry::View view;
  ScansEnRoute en_route{};     ///< en-route scans before this view
  double distance = 0.0;       ///< path length up to and including this view [m]
  std::size_t points = 0;      ///< points kept so far
  std::size_t returns = 0;     ///< points of the scan
  double sensing_time = 0.0;   ///< time of the sensor functions, including en-route scans [s]
  double planning_time = 0.0;  ///< time of the planner's update, including en-route scans [s]
  double planning_processor_time = 0.0;  ///< processor time of this thread [s]
  PlanningStep step;
};

struct SurveyResult {
  StopReason stop_reason = StopReason::complete;
  std::vector<SurveyedView> views;
};

/// Callbacks of a survey.
struct SurveyCallbacks {
  /// Initial pattern: views taken after the first view and before the planner's proposals. Views
  /// that the planner does not allow and unreachable views are skipped. The planner also learns
  /// from these views.
  std::vector<geometry::View> initial_pattern{};
  /// Takes a scan from a view, or from a nearby pose. May reuse the memory of `buffer`, the
  /// previous scan. Used only by run_survey().
  std::function<geometry::Scan(const geometry::View&, geometry::Scan buffer)> sense;
  /// Returns the views of the en-route scans between two views, in order. `sense_en_route` takes
  /// the scans, and `sensed_en_route` receives each of them before the planner. Used only by
  /// run_survey(). Empty: no en-route scans.
  std::function<std::vector<geometry::View>(const geometry::View& from, const geometry::View& to)>
      en_route_views;
  std::function<geometry::Scan(const geometry::View&, geometry::Scan buffer)> sense_en_route;
  std::function<void(const geometry::Scan&)> sensed_en_route;
  /// Receives each scan before the next view is planned. May be empty.
  std::function<void(const geometry::Scan&)> sensed;
  /// Returns whether the sensor can move from a position to a view. Empty: always.
  std::function<bool(const Eigen::Vector3d& from, const geometry::View& to)> can_reach;
  /// Called after each view. May be empty.
  std::function<void(const SurveyedView&, const geometry::Scan&)> report;
  /// Sets the token of stop requests, which let `can_reach` throw Interrupted. May be empty.
  std::function<void(std::stop_token)> stop_on;
};

/// Survey controlled scan by scan, for callers that move the sensor themselves.
class SurveyStepper {
 public:
  /// Keeps a reference to the planner.
  SurveyStepper(Planner& planner, const SurveyLimits& limits, SurveyCallbacks callbacks);

  /// Processes a scan taken en route to the last proposed view. `sensing_time` is its duration [s].
  void pass(const geometry::Scan& scan, double sensing_time = 0.0);

  /// Processes a scan and returns the next view, or nullopt at the end of the survey.
  /// `sensing_time` is the duration of the scan [s]. Throws the errors of the planner.
  std::optional<geometry::View> add_scan(const geometry::Scan& scan, double sensing_time = 0.0);

  /// Rejects the last proposed view and returns another one, or nullopt if there are no more.
  std::optional<geometry::View> reject();

  /// Sets the token of stop requests. A stop request lets add_scan() throw Interrupted; afterwards
  /// only views() may be called. The interrupted scan is not counted, although the planner may have
  /// learnt from it.
  void stop_on(const std::stop_token& stop);

  /// Returns the number of en-route scans to the last proposed view.
  std::size_t passed() const { return coming_.en_route.views.size(); }

  const std::vector<SurveyedView>& views() const& { return views_; }
  std::vector<SurveyedView> views() && { return std::move(views_); }

  /// Returns the reason for the end of the survey, after no view was proposed.
  StopReason stop_reason() const { return stop_reason_; }

 private:
  std::optional<geometry::View> reachable(std::optional<geometry::View> next,
                                          SurveyedView& surveyed_view, bool is_rejected);
  std::optional<geometry::View> within_limits(std::optional<geometry::View> next);
  std::optional<geometry::View> next_initial_view(const SurveyedView& surveyed_view);

  Planner& planner_;
  SurveyLimits limits_;
  SurveyCallbacks callbacks_;
  std::vector<SurveyedView> views_;
  std::size_t initial_views_done_ =
      0;  ///< number of views of the initial pattern that were taken or are unreachable
  SurveyedView coming_;  ///< data of the next view: its en-route scans
  std::stop_token stop_;
  StopReason stop_reason_ = StopReason::complete;
};

/// Runs a survey from `first_view`. Throws the errors of planner and sensor.
SurveyResult run_survey(Planner& planner, const geometry::View& first_view,
                        const SurveyLimits& limits, const SurveyCallbacks& callbacks,
                        std::stop_token stop = {});

}  // namespace skycap::survey
