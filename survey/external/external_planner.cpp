#include "survey/external/external_planner.h"

#include <exception>

#include "geometry/error.h"
#include "survey/stopwatch.h"

namespace skycap::survey::external {
namespace {

LoadedPlanner make_loaded(const ExternalConfig& config) {
  config.validate();
  return config.make(config.task);
}

}  // namespace

void ExternalConfig::validate() const {
  if (file.empty() || !make) {
    throw Error(ErrorKind::bad_config,
                "the planner external requires planner.file; set it to a shared library (.so) or a "
                "Python file (.py)");
  }
}

ExternalPlanner::ExternalPlanner(const ExternalConfig& config)
    : file_(config.file),
      kept_(config.task.spacing, config.task.scene_box),
      loaded_(make_loaded(config)) {}

void ExternalPlanner::stop_on(const std::stop_token& stop) {
  if (loaded_.stop_on) loaded_.stop_on(stop);
}

template <typename Call>
std::optional<geometry::View> ExternalPlanner::call(const Call& planner_call) {
  std::optional<geometry::View> view;
  try {
    view = planner_call(*loaded_.planner);
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& failure) {
    throw Error(ErrorKind::bad_file, file_ + ": " + failure.what());
  }
  if (loaded_.processor_time_elsewhere) {
    step_.processor_time_elsewhere += loaded_.processor_time_elsewhere();
  }
  if (!view) return view;
  const double length = view->direction.norm();
  if (!view->position.allFinite() || !(length > 1e-9 && length < 1e9)) {
    throw Error(ErrorKind::bad_file,
                file_ + ": a view must have a finite position and a direction that is not zero");
  }
  view->direction /= length;
  return view;
}

std::optional<geometry::View> ExternalPlanner::next_view(const geometry::ScanSpan& scan) {
  step_ = {};
  Stopwatch stopwatch(step_.times);
  step_.points_new = kept_.add(scan);
  stopwatch.lap("insert");
  if (kept_.cloud().positions.empty()) {
    throw Error(ErrorKind::bad_geometry,
                "the first scan contains no point of the scene; start from a view that sees it, or "
                "enlarge planner.scene_box");
  }
  const auto view =
      call([&](OwnPlanner& planner) { return planner.next_view(scan, kept_.cloud()); });
  stopwatch.lap("planner");
  return view;
}

std::optional<geometry::View> ExternalPlanner::next_alternative_view() {
  return call([](OwnPlanner& planner) { return planner.next_alternative_view(); });
}

}  // namespace skycap::survey::external
