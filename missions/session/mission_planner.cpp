#include "missions/session/mission_planner.h"

#include <string>
#include <utility>
#include <vector>

#include "survey/coverage_estimator.h"

namespace skycap::missions::session {
namespace {

/// Number of targets for replanning, which is one of eight surfels on a building with a height of
/// 40 m.
constexpr std::size_t surface_targets = 6000;

/// Copies the data that only planners with coverage estimates provide.
void record_belief(const survey::Planner& planner, SurveyRecord& record) {
  const survey::CoverageEstimator* const estimator = planner.estimator();
  if (estimator == nullptr) return;
  record.belief = estimator->belief();
  record.stop_rule = estimator->stop_rule();
}

}  // namespace

struct MissionPlanner::Impl {
  Impl(const SurveyOptions& given, const std::optional<geometry::View>& first_view,
       const survey::PlannerRun& run)
      : options(given), seed(run.seed), planner(survey::make_planner(options.planner, run)) {
    if (!options.flight.is_flown()) return;
    flight.emplace(options.flight, first_view.value(), run.threads);
    planner->keep_to([this](const Eigen::Vector3d& place) { return flight->may_be_at(place); });
  }

  SurveyOptions options;
  std::uint64_t seed;
  std::unique_ptr<survey::Planner> planner;
  std::optional<SurveyFlight> flight;
};

MissionPlanner::MissionPlanner(const SurveyOptions& options,
                               const std::optional<geometry::View>& first_view,
                               const survey::PlannerRun& run)
    : impl_(std::make_unique<Impl>(options, first_view, run)) {}

MissionPlanner::~MissionPlanner() = default;

survey::Planner& MissionPlanner::planner() { return *impl_->planner; }

SurveyFlight* MissionPlanner::flight() { return impl_->flight ? &*impl_->flight : nullptr; }

survey::SurveyPorts MissionPlanner::ports() {
  survey::SurveyPorts ports;
  Impl& impl = *impl_;
  const std::vector<geometry::View> opening = opening_views(impl.options.start, impl.seed);
  if (!opening.empty()) ports.opening.assign(opening.begin() + 1, opening.end());
  if (!impl.flight) return ports;
  ports.sensed = [&impl](const geometry::Scan& scan) {
    impl.flight->fly();
    impl.flight->take_in(scan);
  };
  ports.sensed_on_way = [&impl](const geometry::Scan& scan) { impl.flight->take_in(scan); };
  ports.stop_on = [&impl](std::stop_token stop) { impl.flight->stop_on(std::move(stop)); };
  ports.can_reach = [&impl](const Eigen::Vector3d& from, const geometry::View& view) {
    return impl.flight->can_reach(from, view);
  };
  if (impl.options.flight.capture.is_moving) {
    ports.views_on_way = [&impl](const geometry::View& from, const geometry::View& to) {
      std::vector<geometry::View> views;
      for (const ViewInFlight& frame : impl.flight->frames(from, to)) views.push_back(frame.view);
      return views;
    };
  }
  return ports;
}

survey::SurveyLimits MissionPlanner::limits() const { return impl_->options.limits; }

void MissionPlanner::tell(SurveyRecord& record) const {
  record_belief(*impl_->planner, record);
  record.cloud = impl_->planner->cloud();
}

void MissionPlanner::finish(SurveyRecord& record) {
  record_belief(*impl_->planner, record);
  const survey::CoverageEstimator* const estimator = impl_->planner->estimator();
  if (estimator != nullptr && impl_->flight &&
      impl_->options.flight.views == flight::MissionViews::anew) {
    record.surface = estimator->known_surface(surface_targets);
  }
  record.cloud = impl_->planner->release_cloud();
  if (!impl_->flight) return;
  std::vector<geometry::View> views;
  for (const JudgedView& judged : record.views) views.push_back(judged.surveyed.view);
  record.flown = impl_->flight->finish(views);
}

}  // namespace skycap::missions::session
