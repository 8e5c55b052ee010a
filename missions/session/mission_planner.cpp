#include "missions/session/mission_planner.h"

#include <algorithm>
#include <span>

#include "geometry/points/point_grid.h"
#include "missions/config/opening_flight.h"
#include "missions/config/planner_factory.h"
#include "missions/config/site.h"

namespace skycap::missions::session {
namespace {

constexpr double seconds_per_minute = 60.0;

/// That views chosen anew are weighed by: one of eight surfels of a building 40 m high.
constexpr std::size_t surface_targets = 6000;

/// Takes over what only the planner skycap can say, such as which budget made it stop.
void record_belief(const survey::Planner& planner, SurveyRecord& record) {
  const auto* skycap = dynamic_cast<const survey::skycap::SkycapPlanner*>(&planner);
  if (skycap == nullptr) return;
  record.belief = skycap->belief();
  record.skycap_stop = skycap->stop();
  if (!record.is_complete()) return;
  if (record.skycap_stop == survey::skycap::SkycapStop::most_length) {
    record.stop_reason = survey::StopReason::distance_limit;
  } else if (record.skycap_stop == survey::skycap::SkycapStop::most_time) {
    record.stop_reason = survey::StopReason::time_limit;
  }
}

/// Keeps planners that know nothing of the mission's limits from breaking them.
class ViewGate {
 public:
  explicit ViewGate(const survey::ViewLimits& limits)
      : limits_(limits), grid_(std::max(limits.stand_off, 1e-3)) {}

  void add(std::span<const Eigen::Vector3f> measured) {
    if (limits_.stand_off == 0.0) return;
    for (const Eigen::Vector3f& point : measured) grid_.insert(point);
  }

  bool admits(const geometry::View& view) const {
    return limits_.allow(view) &&
           (limits_.stand_off == 0.0 ||
            !grid_.any_within(view.position.cast<float>(), limits_.stand_off));
  }

 private:
  survey::ViewLimits limits_;
  geometry::PointGrid grid_;
};

}  // namespace

struct MissionPlanner::Impl {
  Impl(const config::Mission& given, const std::optional<geometry::View>& first_view,
       unsigned threads)
      : mission(given),
        planner(config::make_planner(mission, threads)),
        gate(config::view_limits(mission)),
        is_gated(mission.planner.name != config::PlannerName::skycap) {
    if (!mission.flight.is_flown()) return;
    flight.emplace(mission, first_view.value());
    if (auto* skycap = dynamic_cast<survey::skycap::SkycapPlanner*>(planner.get())) {
      skycap->keep_to([this](const Eigen::Vector3d& place) { return flight->may_be_at(place); });
    }
  }

  bool admits(const geometry::View& view) {
    const std::span stored(planner->cloud().positions);
    gate.add(stored.subspan(points_gated));
    points_gated = stored.size();
    return gate.admits(view);
  }

  config::Mission mission;
  std::unique_ptr<survey::Planner> planner;
  std::optional<SurveyFlight> flight;
  ViewGate gate;
  bool is_gated;  ///< the planner skycap keeps the limits by itself
  std::size_t points_gated = 0;
};

MissionPlanner::MissionPlanner(const config::Mission& mission,
                               const std::optional<geometry::View>& first_view, unsigned threads)
    : impl_(std::make_unique<Impl>(mission, first_view, threads)) {}

MissionPlanner::~MissionPlanner() = default;

survey::Planner& MissionPlanner::planner() { return *impl_->planner; }

SurveyFlight* MissionPlanner::flight() { return impl_->flight ? &*impl_->flight : nullptr; }

survey::SurveyPorts MissionPlanner::ports() {
  survey::SurveyPorts ports;
  Impl& impl = *impl_;
  if (impl.flight) {
    ports.sensed = [&impl](const geometry::Scan& scan) {
      impl.flight->fly();
      impl.flight->take_in(scan);
    };
    ports.sensed_on_way = [&impl](const geometry::Scan& scan) { impl.flight->take_in(scan); };
    ports.stop_on = [&impl](std::stop_token stop) { impl.flight->stop_on(std::move(stop)); };
  }
  const std::vector<geometry::View> opening = config::opening_views(impl.mission);
  if (!opening.empty()) ports.opening.assign(opening.begin() + 1, opening.end());
  if (impl.mission.sensor.is_moving()) {
    ports.views_on_way = [&impl](const geometry::View& from, const geometry::View& to) {
      std::vector<geometry::View> views;
      for (const ViewInFlight& frame : impl.flight->frames(from, to)) views.push_back(frame.view);
      return views;
    };
  }
  if (impl.flight || impl.is_gated) {
    ports.can_reach = [&impl](const Eigen::Vector3d& from, const geometry::View& view) {
      if (impl.is_gated && !impl.admits(view)) return false;
      return !impl.flight || impl.flight->can_reach(from, view);
    };
  }
  return ports;
}

survey::SurveyLimits MissionPlanner::limits() const {
  const config::LimitsConfig& config = impl_->mission.limits;
  survey::SurveyLimits limits{.max_views = config::view_limit(impl_->mission),
                              .max_distance = config.max_distance,
                              .speed = config.speed,
                              .time_per_view = config.time_per_view};
  if (config.max_minutes) limits.max_time = seconds_per_minute * *config.max_minutes;
  return limits;
}

void MissionPlanner::tell(SurveyRecord& record) const {
  record_belief(*impl_->planner, record);
  record.cloud = impl_->planner->cloud();
}

void MissionPlanner::finish(SurveyRecord& record) {
  record_belief(*impl_->planner, record);
  const auto* skycap = dynamic_cast<const survey::skycap::SkycapPlanner*>(impl_->planner.get());
  if (skycap != nullptr && impl_->flight &&
      impl_->mission.flight.views == config::MissionViews::anew) {
    record.surface = skycap->known_surface(surface_targets);
  }
  record.cloud = impl_->planner->release_cloud();
  if (!impl_->flight) return;
  std::vector<geometry::View> views;
  for (const JudgedView& judged : record.views) views.push_back(judged.surveyed.view);
  record.flown = impl_->flight->finish(views);
}

}  // namespace skycap::missions::session
