/// Planner and sensor in turn, until the planner is done or a limit is met.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "survey/planner.h"
#include "survey/survey_limits.h"

namespace skycap::survey {

/// Scans that were taken on the way to a view.
struct ScansOnWay {
  std::vector<geometry::View> views;  ///< where they were taken, in order
  std::size_t returns = 0;            ///< points of all of them
};

/// One view of a survey: where the sensor was, and what the planner made of the scan.
struct SurveyedView {
  geometry::View view;
  ScansOnWay on_way{};                   ///< to it
  double distance = 0.0;                 ///< travelled up to and including this view
  std::size_t points = 0;                ///< kept so far
  std::size_t returns = 0;               ///< points of the scan
  double sensing_time = 0.0;             ///< [s], of the sensor function, on the way too
  double planning_time = 0.0;            ///< [s], of the planner's update, on the way too
  double planning_processor_time = 0.0;  ///< [s], of this thread alone
  PlanningStep step;
};

struct SurveyResult {
  StopReason stop_reason = StopReason::complete;
  std::vector<SurveyedView> views;
};

/// Who has a say while a survey goes on.
struct SurveyPorts {
  /// Views that are taken before the planner is asked for any, after the first: those that it
  /// allows and that can be reached. The planner learns from them as from its own.
  std::vector<geometry::View> opening{};
  /// Takes a scan from a view (or as near to it as it could). The memory of `recycled`, the scan
  /// before it, may be used again. For run_survey() alone.
  std::function<geometry::Scan(const geometry::View&, geometry::Scan recycled)> sense;
  /// Views of the scans that are taken on the way from one view to the next, in order; they are
  /// sensed by `sense_on_way`, and `sensed_on_way` is told of each before the planner. For
  /// run_survey() alone. Empty: none.
  std::function<std::vector<geometry::View>(const geometry::View& from, const geometry::View& to)>
      views_on_way;
  std::function<geometry::Scan(const geometry::View&, geometry::Scan recycled)> sense_on_way;
  std::function<void(const geometry::Scan&)> sensed_on_way;
  /// Told of each scan before the next view is planned. May be empty.
  std::function<void(const geometry::Scan&)> sensed;
  /// Whether the sensor can get from one place to a view. Empty: it always can.
  std::function<bool(const Eigen::Vector3d& from, const geometry::View& to)> can_reach;
  /// Told after each view. May be empty.
  std::function<void(const SurveyedView&, const geometry::Scan&)> report;
  /// Lets a stop end `can_reach` wherever it is: it then throws Interrupted. May be empty.
  std::function<void(std::stop_token)> stop_on;
};

/// A survey scan by scan, for whoever moves the sensor.
class SurveySteps {
 public:
  /// Keeps a reference to the planner.
  SurveySteps(Planner& planner, const SurveyLimits& limits, SurveyPorts ports);

  /// Takes in a scan from the way to the view that was proposed last, which took so long [s].
  void pass(const geometry::Scan& scan, double sensing_time = 0.0);

  /// Takes in a scan, which took so long [s], and says where the next one is to be taken; nothing
  /// when the survey is over. Throws what the planner throws.
  std::optional<geometry::View> take_in(const geometry::Scan& scan, double sensing_time = 0.0);

  /// Another view in place of the one that was proposed last; nothing when there is none left.
  std::optional<geometry::View> refuse();

  /// Lets a stop end take_in() wherever it is: it then throws Interrupted, and nothing but views()
  /// may be asked for. The scan counts as not taken, though the planner may have learnt from it.
  void stop_on(const std::stop_token& stop);

  /// Scans from the way to the view that was proposed last.
  std::size_t passed() const { return coming_.on_way.views.size(); }

  const std::vector<SurveyedView>& views() const& { return views_; }
  std::vector<SurveyedView> views() && { return std::move(views_); }

  /// Why the survey is over, once no view is proposed.
  StopReason stop_reason() const { return stop_reason_; }

 private:
  std::optional<geometry::View> reachable(std::optional<geometry::View> next, SurveyedView& taken,
                                          bool is_refused);
  std::optional<geometry::View> within_limits(std::optional<geometry::View> next);
  std::optional<geometry::View> opening_view(const SurveyedView& taken);

  Planner& planner_;
  SurveyLimits limits_;
  SurveyPorts ports_;
  std::vector<SurveyedView> views_;
  std::size_t opened_ = 0;  ///< views of the opening that were taken or cannot be reached
  SurveyedView coming_;     ///< what is known of the next view: the scans on the way to it
  std::stop_token stop_;
  StopReason stop_reason_ = StopReason::complete;
};

/// Runs a survey from `first_view`. Throws what planner and sensor throw.
SurveyResult run_survey(Planner& planner, const geometry::View& first_view,
                        const SurveyLimits& limits, const SurveyPorts& ports,
                        std::stop_token stop = {});

}  // namespace skycap::survey
