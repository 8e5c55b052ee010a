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
using flight::Station;

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
constexpr std::size_t most_pads_tried = 3;

/// Returns a path from above a pad to a position: straight, or over all obstacles in between and
/// then shortened. Empty if neither is free. This takes little time, whereas a path search through
/// a town takes a second.
package::Way way_over(const flight::FreeSpace& space, const Vector3d& home, const Vector3d& place,
                      double level, const flight::RouteOptions& options) {
  const double clearance = options.clearance.total();
  if (space.is_free({home, place}, clearance)) return {home, place};
  package::Way way{home, {home.x(), home.y(), level}, {place.x(), place.y(), level}, place};
  for (std::size_t i = 1; i < way.size(); ++i) {
    if (!space.is_free({way[i - 1], way[i]}, clearance)) return {};
  }
  return flight::pull_tight(space, clearance, std::move(way), options.path.worthwhile_saving);
}

class FlightPlanner {
 public:
  FlightPlanner(const DistrictFile& district, const Prepared& prepared,
                std::span<const SurveyedTarget> targets, const fs::path& out, const Tell& tell,
                const std::stop_token& stop)
      : prepared_(prepared), targets_(targets), tell_(tell), stop_(stop) {
    for (std::size_t pad = 0; pad < prepared.pads.size(); ++pad) {
      const fs::path file = out / flights_folder / (pad_name(pad) + ".yaml");
      const config::MissionSetup mission = config::read_mission(file, district.set);
      names_.push_back(mission.name);
      flights_.push_back(package::in_given_order(mission.flight()));
    }
  }

  DistrictFlight plan(geometry::OutputFolder& folder) {
    if (flights_.empty()) return {};
    take_surveys();
    if (!choose_pads()) return {};
    routes_.resize(flights_.size());
    std::vector<bool> is_changed(flights_.size(), true);
    while (std::ranges::count(is_changed, true) > 0 && !stop_.stop_requested()) {
      for (std::size_t pad = 0; pad < flights_.size(); ++pad) {
        if (is_changed[pad]) plan_pad(pad);
      }
      is_changed = move_refused();
    }
    if (stop_.stop_requested()) return {};
    finish(folder);
    return std::move(flight_);
  }

 private:
  /// Reads the views and free spaces of all targets. Targets without a survey have no free space.
  void take_surveys() {
    std::vector<flight::MeasuredSpace> spaces;
    for (std::size_t t = 0; t < targets_.size() && !stop_.stop_requested(); ++t) {
      const SurveyedTarget& target = targets_[t];
      tell_(fmt::format("merging survey {} of {}", t + 1, targets_.size()));
      if (!target.figures) {
        flight::FlightOptions unmeasured = flights_.front();
        unmeasured.unknown_box = target.target.unknown;
        spaces.emplace_back(unmeasured.measured_space());
        continue;
      }
      package::PackagedSurvey input = package::read_package(target.figures->folder, {});
      spaces.push_back(std::move(input.measured));
      grounds_.insert(grounds_.end(), input.grounds.begin(), input.grounds.end());
      const std::vector<package::Way> ways(input.views.size());
      for (Station& station : package::stations_of(flights_.front(), input.views, ways)) {
        flight_.stations.push_back({t, station.view_index, ""});
        of_target_.push_back(static_cast<std::uint32_t>(t));
        station.view_index = static_cast<std::uint32_t>(stations_.size());
        stations_.push_back(std::move(station));
      }
    }
    measured_ = std::make_unique<flight::MeasuredUnion>(std::move(spaces));
  }

  /// Assigns an order and pads to all waypoints. Returns whether there are any waypoints.
  bool choose_pads() {
    tell_(fmt::format("ordering {} views", stations_.size()));
    const flight::RouteOptions options = flights_.front().route(prepared_.pads[0]);
    const flight::Motion motion(flights_.front().flown(), options.conditions);
    const flight::PadSorties sorties = flight::sorties_from_pads(
        stations_, of_target_, prepared_.pads, options.takeoff_climb, motion);
    for (const std::uint32_t i : sorties.out_of_reach) {
      flight_.stations[i].why_not =
          "the flight there and back needs more than one battery, from every take-off point";
    }
    order_ = sorties.order;
    flight_.order_length = sorties.length;
    pad_of_.resize(stations_.size(), flights_.size());
    tried_.resize(stations_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      pad_of_[order_[i]] = sorties.pads[i];
      tried_[order_[i]] = {sorties.pads[i]};
    }
    return !order_.empty();
  }

  void plan_pad(std::size_t pad) {
    std::vector<Station> own;
    for (const std::uint32_t i : order_) {
      if (pad_of_[i] == pad) own.push_back(stations_[i]);
    }
    routes_[pad].reset();
    for (const Station& station : own) flight_.stations[station.view_index].why_not.clear();
    if (own.empty()) return;
    tell_(fmt::format("verifying legs from take-off point {} of {} to {} views", pad + 1,
                      flights_.size(), own.size()));
    take_ways(pad, own);
    try {
      routes_[pad] = package::plan_flight(flights_[pad], *measured_, prepared_.pads[pad], own,
                                          grounds_, stop_);
    } catch (const Interrupted&) {
      return;
    } catch (const Error& error) {
      for (const Station& station : own) {
        flight_.stations[station.view_index].why_not = error.what();
      }
      return;
    }
    for (const flight::Unreached& missed : routes_[pad]->unreached) {
      flight_.stations[missed.station.view_index].why_not = missed.reason;
    }
  }

  /// Proposes a path from above the pad to each waypoint.
  void take_ways(std::size_t pad, std::vector<Station>& stations) const {
    const flight::FlightOptions& flight = flights_[pad];
    const Vector3d& place = prepared_.pads[pad];
    const flight::KnownSpace known(flight.rules());
    const flight::JointSpace space({measured_.get(), &known});
    const flight::RouteOptions options = flight.route(place);
    const Vector3d home = place + options.takeoff_climb * Vector3d::UnitZ();
    const double level = flight.highest_return(place.z(), place.z());
    for (Station& station : stations) {
      if (stop_.stop_requested()) return;
      station.way = way_over(space, home, station.view.position, level, options);
    }
  }

  /// Reassigns unreachable waypoints to the nearest pad that has not been tried. Returns which pads
  /// have new waypoints.
  std::vector<bool> move_refused() {
    std::vector<bool> is_changed(flights_.size(), false);
    for (const std::uint32_t i : order_) {
      if (flight_.stations[i].why_not.empty() || tried_[i].size() >= most_pads_tried) continue;
      const std::optional<std::size_t> next = nearest_untried(i);
      if (!next) continue;
      is_changed[*next] = true;
      pad_of_[i] = *next;
      tried_[i].push_back(*next);
    }
    return is_changed;
  }

  std::optional<std::size_t> nearest_untried(std::uint32_t station) const {
    std::optional<std::size_t> nearest;
    const auto distance = [&](std::size_t pad) {
      return (stations_[station].view.position - prepared_.pads[pad]).norm();
    };
    for (std::size_t pad = 0; pad < prepared_.pads.size(); ++pad) {
      if (std::ranges::count(tried_[station], pad) > 0) continue;
      if (!nearest || distance(pad) < distance(*nearest)) nearest = pad;
    }
    return nearest;
  }

  void finish(geometry::OutputFolder& folder) {
    for (std::size_t pad = 0; pad < routes_.size(); ++pad) {
      if (!routes_[pad] || routes_[pad]->sorties.empty()) continue;
      tell_(fmt::format("writing {} sorties from take-off point {}", routes_[pad]->sorties.size(),
                        pad + 1));
      PadFlight own{pad, *std::move(routes_[pad])};
      own.files = package::stage_flight(names_[pad], flights_[pad], own.route, *measured_,
                                        package::package_formats(flights_[pad].flown().dialect),
                                        folder, pad_name(pad));
      for (const std::string& note : own.files.notes) flight_.notes.push_back(note);
      flight_.pads.push_back(std::move(own));
    }
  }

  const Prepared& prepared_;
  std::span<const SurveyedTarget> targets_;
  const Tell& tell_;
  const std::stop_token& stop_;
  std::vector<std::string> names_;              ///< mission names by pad
  std::vector<flight::FlightOptions> flights_;  ///< flight options by pad
  std::unique_ptr<const flight::MeasuredUnion> measured_;
  std::vector<flight::PadGround> grounds_;
  std::vector<Station> stations_;
  std::vector<std::uint32_t> of_target_, order_;
  std::vector<std::size_t> pad_of_;              ///< assigned pad by waypoint
  std::vector<std::vector<std::size_t>> tried_;  ///< pads tried by waypoint
  std::vector<std::optional<flight::Route>> routes_;
  DistrictFlight flight_;
};

}  // namespace

SurveyFigures figures_of(const fs::path& folder, const TrialRecord& record) {
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
    throw Error(ErrorKind::bad_file, file.string() + ": is not a survey's summary (" +
                                         error.what() + "); remove its folder, and run again");
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

DistrictFlight plan_district(const DistrictFile& district, const Prepared& prepared,
                             std::span<const SurveyedTarget> targets, const fs::path& out,
                             const Tell& tell, const std::stop_token& stop) {
  geometry::OutputFolder folder(out / flights_folder);
  folder.replace([](std::string_view name) { return !name.ends_with(".yaml"); });
  DistrictFlight flight = FlightPlanner(district, prepared, targets, out, tell, stop).plan(folder);
  if (!stop.stop_requested()) folder.commit();
  return flight;
}

}  // namespace skycap::missions::batch
