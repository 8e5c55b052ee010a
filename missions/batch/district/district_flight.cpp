#include "missions/batch/district/district_flight.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/district/measured_union.h"
#include "flight/district/pad_sorties.h"
#include "flight/paths/path.h"
#include "geometry/error.h"
#include "geometry/interrupted.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "missions/config/resolve.h"
#include "missions/package/package.h"

namespace skycap::missions::batch {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using flight::CapturePoint;

/// Returns the area-weighted mean coverage of the target's objects.
double coverage_in(const nlohmann::json& targets) {
  double area = 0.0, covered = 0.0;
  for (const nlohmann::json& target : targets) {
    area += target.at("area_m2").get<double>();
    covered += target.at("area_m2").get<double>() * target.at("coverage").get<double>();
  }
  return area > 0.0 ? covered / area : 0.0;
}

std::size_t bytes_in(const fs::path& folder) {
  std::size_t bytes = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  return bytes;
}

/// Maximum number of pads from which a waypoint is tried.
constexpr std::size_t max_pads_tried = 3;

/// Returns a path from above a pad to a position: straight, or over all obstacles in between and
/// then shortened. Empty if neither is free. This takes little time, whereas a path search through
/// a town takes a second.
package::Polyline path_over(const flight::FreeSpace& space, const Vector3d& home,
                            const Vector3d& pad_position, double level,
                            const flight::RouteOptions& options) {
  const double clearance = options.clearance.total();
  if (space.is_free({home, pad_position}, clearance)) return {home, pad_position};
  package::Polyline approach_path{
      home, {home.x(), home.y(), level}, {pad_position.x(), pad_position.y(), level}, pad_position};
  for (std::size_t i = 1; i < approach_path.size(); ++i) {
    if (!space.is_free({approach_path[i - 1], approach_path[i]}, clearance)) return {};
  }
  return flight::pull_tight(space, clearance, std::move(approach_path),
                            options.path.worthwhile_saving);
}

class FlightPlanner {
 public:
  FlightPlanner(const DistrictFile& district, const DistrictPlan& district_plan,
                std::span<const SurveyedTarget> targets, const fs::path& out,
                const ReportProgress& report_progress, const std::stop_token& stop)
      : district_plan_(district_plan),
        targets_(targets),
        report_progress_(report_progress),
        stop_(stop) {
    for (std::size_t pad = 0; pad < district_plan.pads.size(); ++pad) {
      const fs::path file = out / flights_folder / (pad_name(pad) + ".yaml");
      const config::MissionSetup mission = config::read_mission(file, district.set);
      names_.push_back(mission.name);
      flights_.push_back(package::with_fixed_order(mission.flight()));
    }
  }

  DistrictFlight plan(geometry::OutputFolder& folder) {
    if (flights_.empty()) return {};
    load_surveys();
    if (!choose_pads()) return {};
    routes_.resize(flights_.size());
    std::vector<bool> is_changed(flights_.size(), true);
    while (std::ranges::count(is_changed, true) > 0 && !stop_.stop_requested()) {
      for (std::size_t pad = 0; pad < flights_.size(); ++pad) {
        if (is_changed[pad]) plan_pad(pad);
      }
      is_changed = move_rejected();
    }
    if (stop_.stop_requested()) return {};
    finish(folder);
    return std::move(flight_);
  }

 private:
  /// Reads the views and free spaces of all targets. Targets without a survey have no free space.
  void load_surveys() {
    std::vector<flight::MeasuredSpace> spaces;
    for (std::size_t t = 0; t < targets_.size() && !stop_.stop_requested(); ++t) {
      const SurveyedTarget& target = targets_[t];
      report_progress_(fmt::format("merging survey {} of {}", t + 1, targets_.size()));
      if (!target.figures) {
        flight::FlightOptions unmeasured = flights_.front();
        unmeasured.unknown_box = target.target.unknown;
        spaces.emplace_back(unmeasured.measured_space());
        continue;
      }
      package::PackagedSurvey input = package::read_package(target.figures->folder, {});
      spaces.push_back(std::move(input.measured));
      landing_surfaces_.insert(landing_surfaces_.end(), input.landing_surfaces.begin(),
                               input.landing_surfaces.end());
      const std::vector<package::Polyline> paths(input.views.size());
      for (CapturePoint& capture_point :
           package::make_capture_points(flights_.front(), input.views, paths)) {
        flight_.capture_points.push_back({t, capture_point.view_index, ""});
        target_indices_.push_back(static_cast<std::uint32_t>(t));
        capture_point.view_index = static_cast<std::uint32_t>(capture_points_.size());
        capture_points_.push_back(std::move(capture_point));
      }
    }
    measured_ = std::make_unique<flight::MeasuredUnion>(std::move(spaces));
  }

  /// Assigns an order and pads to all waypoints. Returns whether there are any waypoints.
  bool choose_pads() {
    report_progress_(fmt::format("ordering {} views", capture_points_.size()));
    const flight::RouteOptions options = flights_.front().route(district_plan_.pads[0]);
    const flight::Motion motion(flights_.front().required_vehicle(), options.conditions);
    const flight::PadSorties sorties = flight::sorties_from_pads(
        capture_points_, target_indices_, district_plan_.pads, options.takeoff_climb, motion);
    for (const std::uint32_t i : sorties.unreachable) {
      flight_.capture_points[i].skip_reason =
          "the flight to it and back requires more than one battery from every take-off point";
    }
    order_ = sorties.order;
    flight_.order_length = sorties.length;
    pad_indices_.resize(capture_points_.size(), flights_.size());
    tried_.resize(capture_points_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      pad_indices_[order_[i]] = sorties.pads[i];
      tried_[order_[i]] = {sorties.pads[i]};
    }
    return !order_.empty();
  }

  void plan_pad(std::size_t pad) {
    std::vector<CapturePoint> own;
    for (const std::uint32_t i : order_) {
      if (pad_indices_[i] == pad) own.push_back(capture_points_[i]);
    }
    routes_[pad].reset();
    for (const CapturePoint& capture_point : own)
      flight_.capture_points[capture_point.view_index].skip_reason.clear();
    if (own.empty()) return;
    report_progress_(fmt::format("verifying legs from take-off point {} of {} to {} views", pad + 1,
                                 flights_.size(), own.size()));
    plan_paths(pad, own);
    try {
      routes_[pad] = package::plan_flight(flights_[pad], *measured_, district_plan_.pads[pad], own,
                                          landing_surfaces_, stop_);
    } catch (const Interrupted&) {
      return;
    } catch (const Error& error) {
      for (const CapturePoint& capture_point : own) {
        flight_.capture_points[capture_point.view_index].skip_reason = error.what();
      }
      return;
    }
    for (const flight::Unreached& missed : routes_[pad]->unreached) {
      flight_.capture_points[missed.capture_point.view_index].skip_reason = missed.reason;
    }
  }

  /// Proposes a path from above the pad to each waypoint.
  void plan_paths(std::size_t pad, std::vector<CapturePoint>& capture_points) const {
    const flight::FlightOptions& flight = flights_[pad];
    const Vector3d& pad_position = district_plan_.pads[pad];
    const flight::KnownSpace known(flight.rules());
    const flight::JointSpace space({measured_.get(), &known});
    const flight::RouteOptions options = flight.route(pad_position);
    const Vector3d home = pad_position + options.takeoff_climb * Vector3d::UnitZ();
    const double level = flight.max_return_altitude(pad_position.z(), pad_position.z());
    for (CapturePoint& capture_point : capture_points) {
      if (stop_.stop_requested()) return;
      capture_point.approach_path =
          path_over(space, home, capture_point.view.position, level, options);
    }
  }

  /// Reassigns unreachable waypoints to the nearest pad that has not been tried. Returns which pads
  /// have new waypoints.
  std::vector<bool> move_rejected() {
    std::vector<bool> is_changed(flights_.size(), false);
    for (const std::uint32_t i : order_) {
      if (flight_.capture_points[i].skip_reason.empty() || tried_[i].size() >= max_pads_tried)
        continue;
      const std::optional<std::size_t> next = nearest_untried(i);
      if (!next) continue;
      is_changed[*next] = true;
      pad_indices_[i] = *next;
      tried_[i].push_back(*next);
    }
    return is_changed;
  }

  std::optional<std::size_t> nearest_untried(std::uint32_t capture_point) const {
    std::optional<std::size_t> nearest;
    const auto distance = [&](std::size_t pad) {
      return (capture_points_[capture_point].view.position - district_plan_.pads[pad]).norm();
    };
    for (std::size_t pad = 0; pad < district_plan_.pads.size(); ++pad) {
      if (std::ranges::count(tried_[capture_point], pad) > 0) continue;
      if (!nearest || distance(pad) < distance(*nearest)) nearest = pad;
    }
    return nearest;
  }

  void finish(geometry::OutputFolder& folder) {
    for (std::size_t pad = 0; pad < routes_.size(); ++pad) {
      if (!routes_[pad] || routes_[pad]->sorties.empty()) continue;
      report_progress_(fmt::format("writing {} sorties from take-off point {}",
                                   routes_[pad]->sorties.size(), pad + 1));
      PadFlight own{pad, *std::move(routes_[pad])};
      own.files = package::stage_flight(names_[pad], flights_[pad], own.route, *measured_,
                                        package::package_formats(flights_[pad].required_vehicle()),
                                        folder, pad_name(pad));
      for (const std::string& note : own.files.notes) flight_.notes.push_back(note);
      flight_.pads.push_back(std::move(own));
    }
  }

  const DistrictPlan& district_plan_;
  std::span<const SurveyedTarget> targets_;
  const ReportProgress& report_progress_;
  const std::stop_token& stop_;
  std::vector<std::string> names_;              ///< mission names by pad
  std::vector<flight::FlightOptions> flights_;  ///< flight options by pad
  std::unique_ptr<const flight::MeasuredUnion> measured_;
  std::vector<flight::LandingSurface> landing_surfaces_;
  std::vector<CapturePoint> capture_points_;
  std::vector<std::uint32_t> target_indices_, order_;
  std::vector<std::size_t> pad_indices_;         ///< assigned pad by waypoint
  std::vector<std::vector<std::size_t>> tried_;  ///< pads tried by waypoint
  std::vector<std::optional<flight::Route>> routes_;
  DistrictFlight flight_;
};

}  // namespace

SurveyFigures compute_figures(const fs::path& folder, const TrialRecord& record) {
  geometry::finish_commit(folder);
  const fs::path file = folder / package::summary_name;
  try {
    const nlohmann::json summary =
        geometry::parse_json<nlohmann::json>(geometry::read_file(file, geometry::largest_json));
    SurveyFigures figures{.folder = folder,
                          .views = summary.at("views"),
                          .coverage = coverage_in(summary.at("targets")),
                          .coverage_visible = {},
                          .planning_time = record.trial.planning_time,
                          .wall_time = record.run.wall_time,
                          .peak_memory = record.run.peak_memory,
                          .file_bytes = bytes_in(folder),
                          .stop_reason = summary.at("stop_reason")};
    const nlohmann::json& visible = summary.at("coverage_visible");
    if (visible.is_number()) figures.coverage_visible = visible.get<double>();
    if (const auto& flight = summary.at("flight"); flight.contains("route")) {
      figures.time = flight["route"].at("duration_s");
      figures.length = flight["route"].at("length_m");
    }
    return figures;
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::bad_file, file.string() + ": is not the summary of a survey (" +
                                         error.what() +
                                         "); remove its folder and run the command again");
  }
}

std::size_t DistrictFlight::sorties() const {
  std::size_t sum = 0;
  for (const PadFlight& pad : pads) sum += pad.route.sorties.size();
  return sum;
}

double DistrictFlight::duration() const {
  double sum = 0.0;
  for (const PadFlight& pad : pads) sum += pad.route.duration;
  return sum;
}

double DistrictFlight::length() const {
  double sum = 0.0;
  for (const PadFlight& pad : pads) sum += pad.route.length;
  return sum;
}

DistrictFlight plan_district(const DistrictFile& district, const DistrictPlan& district_plan,
                             std::span<const SurveyedTarget> targets, const fs::path& out,
                             const ReportProgress& report_progress, const std::stop_token& stop) {
  geometry::OutputFolder folder(out / flights_folder);
  folder.replace([](std::string_view name) { return !name.ends_with(".yaml"); });
  DistrictFlight flight =
      FlightPlanner(district, district_plan, targets, out, report_progress, stop).plan(folder);
  if (!stop.stop_requested()) folder.commit();
  return flight;
}

}  // namespace skycap::missions::batch
