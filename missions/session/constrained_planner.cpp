#include "missions/session/constrained_planner.h"

#include <string>
#include <utility>
#include <vector>

#include "survey/coverage_estimator.h"

namespace skycap::missions::session {
namespace {

/// Number of targets for replanning, which is one of eight surfels on a building with a height of
/// 40 m.
constexpr std::size_t surface_targets = 6000;

/// Copies the data that only planners with coverage estimates, or with patterns, provide.
void record_estimate(const survey::Planner& planner, SurveyRecord& record) {
  record.pattern = planner.pattern();
  const survey::CoverageEstimator* const estimator = planner.estimator();
  if (estimator == nullptr) return;
  record.estimate = estimator->estimate();
  record.stop_rule = estimator->stop_rule();
}

}  // namespace

struct ConstrainedPlanner::Impl {
  Impl(const SurveyOptions& given, const std::optional<geometry::View>& first_view,
       const survey::PlannerRun& run)
      : options(given), seed(run.seed), planner(survey::make_planner(options.planner, run)) {
    if (!options.flight.has_vehicle()) return;
    flight.emplace(options.flight, first_view.value(), run.threads);
    planner->keep_to(
        [this](const Eigen::Vector3d& position) { return flight->may_be_at(position); });
  }

  SurveyOptions options;
  std::uint64_t seed;
  std::unique_ptr<survey::Planner> planner;
  std::optional<SurveyFlight> flight;
};

ConstrainedPlanner::ConstrainedPlanner(const SurveyOptions& options,
                                       const std::optional<geometry::View>& first_view,
                                       const survey::PlannerRun& run)
    : impl_(std::make_unique<Impl>(options, first_view, run)) {}

ConstrainedPlanner::~ConstrainedPlanner() = default;

survey::Planner& ConstrainedPlanner::planner() { return *impl_->planner; }

SurveyFlight* ConstrainedPlanner::flight() { return impl_->flight ? &*impl_->flight : nullptr; }

survey::SurveyCallbacks ConstrainedPlanner::callbacks() {
  survey::SurveyCallbacks callbacks;
  Impl& impl = *impl_;
  const std::vector<geometry::View> initial_pattern =
      initial_pattern_views(impl.options.start, impl.seed);
  if (!initial_pattern.empty())
    callbacks.initial_pattern.assign(initial_pattern.begin() + 1, initial_pattern.end());
  if (!impl.flight) return callbacks;
  callbacks.sensed = [&impl](const geometry::Scan& scan) {
    impl.flight->fly();
    impl.flight->add_scan(scan);
  };
  callbacks.sensed_en_route = [&impl](const geometry::Scan& scan) { impl.flight->add_scan(scan); };
  callbacks.stop_on = [&impl](std::stop_token stop) { impl.flight->stop_on(std::move(stop)); };
  callbacks.can_reach = [&impl](const Eigen::Vector3d& from, const geometry::View& view) {
    return impl.flight->can_reach(from, view);
  };
  if (impl.options.flight.capture.is_moving) {
    callbacks.en_route_views = [&impl](const geometry::View& from, const geometry::View& to) {
      std::vector<geometry::View> views;
      for (const ViewInFlight& frame : impl.flight->frames(from, to)) views.push_back(frame.view);
      return views;
    };
  }
  return callbacks;
}

survey::SurveyLimits ConstrainedPlanner::limits() const { return impl_->options.limits; }

void ConstrainedPlanner::fill_record(SurveyRecord& record) const {
  record_estimate(*impl_->planner, record);
  record.cloud = impl_->planner->cloud();
}

void ConstrainedPlanner::finish(SurveyRecord& record) {
  record_estimate(*impl_->planner, record);
  const survey::CoverageEstimator* const estimator = impl_->planner->estimator();
  if (estimator != nullptr && impl_->flight &&
      impl_->options.flight.views != flight::MissionViews::survey) {
    record.surface = estimator->known_surface(surface_targets);
  }
  record.cloud = impl_->planner->take_cloud();
  if (!impl_->flight) return;
  std::vector<geometry::View> views;
  for (const EvaluatedView& evaluated : record.views) views.push_back(evaluated.surveyed.view);
  record.flight_record = impl_->flight->finish(views);
}

}  // namespace skycap::missions::session
