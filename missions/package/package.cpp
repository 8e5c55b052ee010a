#include "missions/package/package.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string_view>
#include <type_traits>
#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/place/pose.h"
#include "geometry/place/world.h"
#include "missions/derived/resolved_mission.h"
#include "missions/file/json_text.h"
#include "missions/file/mission_keys.h"
#include "missions/file/number_text.h"
#include "missions/package/cloud_normals.h"
#include "missions/package/coverage_map.h"
#include "missions/version.h"

namespace skycap::missions::package {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* free_space_name = "free_space.bin";

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorKind::bad_file, file.string() + ": " + what);
}

Json json_of(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json json_of(const std::optional<double>& number) { return number ? Json(*number) : Json(); }

Json json_of(const std::vector<survey::PartTime>& times) {
  Json parts = Json::object();
  for (const auto& [part, seconds] : times) parts[part] = seconds;
  return parts;
}

Json json_of(const std::vector<Eigen::Vector2d>& polygon) {
  Json corners = Json::array();
  for (const Eigen::Vector2d& corner : polygon) corners.push_back({corner.x(), corner.y()});
  return corners;
}

Json json_of(const std::vector<geometry::Prism>& volumes) {
  Json list = Json::array();
  for (const geometry::Prism& volume : volumes) {
    list.push_back({{"corners", json_of(volume.footprint)},
                    {"bottom", volume.floor},
                    {"top", volume.ceiling}});
  }
  return list;
}

Json json_of(const std::vector<Eigen::Vector3d>& vectors) {
  Json list = Json::array();
  for (const Eigen::Vector3d& vector : vectors) list.push_back(json_of(vector));
  return list;
}

Json setting_json(const file::KeyValue& value) {
  return std::visit(
      [](const auto& plain) -> Json {
        using Value = std::decay_t<decltype(plain)>;
        if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>) {
          return plain;
        } else {
          return json_of(plain);
        }
      },
      value);
}

/// Settings as a mission file has them. JSON is YAML, but keys are nested there.
std::string mission_text(const Json& settings) {
  Json nested = Json::object();
  for (const auto& [path, value] : settings.items()) {
    // A pointer with a number in it would grow a list; no key of ours has one.
    if (!file::find_key(path)) throw Error(ErrorKind::bad_file, "settings." + path + " is unknown");
    std::string pointer = "/" + path;
    std::ranges::replace(pointer, '.', '/');
    nested[Json::json_pointer(pointer)] = value;
  }
  return nested.dump(1, ' ', false, Json::error_handler_t::replace);
}

/// What the planner believes at the end: shares are of the surface, seen and guessed.
Json belief_summary(const run::SurveyRecord& record) {
  if (!record.belief) return {};
  const survey::skycap::SurveyBelief& belief = *record.belief;
  return {{"stop", run::name_of(record.skycap_stop)},
          {"predicted_coverage", belief.coverage},
          {"area_m2", belief.area},
          {"missing",
           {{"seen_too_thinly", belief.seen_too_thinly},
            {"never_seen", belief.never_seen},
            {"unreachable", belief.unreachable}}},
          {"next_gain", belief.next_gain},
          {"noise_m", belief.noise}};
}

std::string value_text(const file::Mission& mission, const char* key) {
  return file::to_text(*file::find_key(key)->get(mission));
}

/// All keys as they were in force, so that the survey can be repeated from its package.
Json settings(const file::Mission& mission) {
  Json values = Json::object();
  for (const file::Key& key : file::mission_keys()) {
    if (const auto value = key.get(mission)) values[key.path] = setting_json(*value);
  }
  return values;
}

/// How the vehicle comes home when its link, its battery or its pilot asks for it.
Json return_summary(const SurveyMission& flight) {
  if (!flight.route.returns) return {};
  const flight::Returns& returns = *flight.route.returns;
  return {{"height_m", returns.height},
          {"clearance_m", returns.clearance},
          {"nearest",
           {{"from", json_of(returns.nearest.from)},
            {"part", name_of(returns.nearest.piece.part)},
            {"obstacle", returns.obstacle}}},
          {"landings", json_of(returns.law.landings)},
          {"energy_wh", returns.energy / 3600.0},
          {"parameters", flight.files.parameters}};
}

/// The flight of the survey and the route in the package, in metres, seconds and watt hours.
Json flight_summary(const run::FlownSurvey& flown, const SurveyMission& flight) {
  const flight::Route& route = flight.route;
  const flight::ClearanceBudget& clearance = route.options.clearance;
  Json sorties = Json::array(), unreached = Json::array(), files = Json::array();
  for (const flight::Sortie& sortie : route.sorties) {
    sorties.push_back({{"first_station", sortie.first},
                       {"last_station", sortie.last},
                       {"duration_s", sortie.duration},
                       {"energy_wh", sortie.energy / 3600.0},
                       {"energy_left_wh", sortie.energy_left / 3600.0}});
  }
  for (const flight::Unreached& missed : route.unreached) {
    unreached.push_back({{"view", missed.station.view_index}, {"reason", missed.reason}});
  }
  for (const FlightFile& file : flight.files.written) {
    files.push_back({{"name", file.name},
                     {"heights", file.heights},
                     {"min_clearance_m", file.min_clearance},
                     {"duration_s", file.duration}});
  }
  Json order = Json::array();
  for (const flight::Station& station : route.stations) order.push_back(station.view_index);
  return {{"vehicle", route.vehicle.name},
          {"clearance_m",
           {{"total", clearance.total()},
            {"vehicle_radius", clearance.vehicle_radius},
            {"position_error", clearance.position_error},
            {"tracking_error", clearance.tracking_error},
            {"map_error", clearance.map_error},
            {"margin", clearance.margin}}},
          {"pad", json_of(flown.pad)},
          {"survey",
           {{"length_m", flown.length()},
            {"min_clearance_m", flown.min_clearance()},
            {"views_refused", flown.refused},
            {"free_volume_m3", flown.measured->free_volume()}}},
          {"route",
           {{"stations", route.stations.size()},
            {"order", order},
            {"length_m", route.length},
            {"station_length_m", route.station_length},
            {"straight_length_m", route.straight_length},
            {"order_length_m", route.order_length},
            {"order_bound_m", route.order_bound},
            {"duration_s", route.duration},
            {"duration_bound_s", route.duration_bound},
            {"energy_wh", route.energy / 3600.0},
            {"min_clearance_m", route.min_clearance},
            {"sorties", sorties},
            {"unreached", unreached}}},
          {"return", return_summary(flight)},
          {"files", files},
          {"notes", flight.files.notes}};
}

/// The mission that the settings of a summary stand for. Errors name the file.
file::Mission mission_of(const Json& settings, const std::filesystem::path& file,
                         const std::vector<file::KeyOverride>& overrides) {
  std::string text;
  try {
    text = mission_text(settings);
  } catch (const Error& error) {
    throw Error(error.kind(), file.string() + ": " + error.what());
  }
  return derived::parse_mission(text, file.string(), overrides);
}

Eigen::Vector3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// The summary of a package. Throws Error{bad_file}.
Json read_summary(const std::filesystem::path& file) {
  constexpr std::size_t largest = std::size_t{256} << 20;  // of a million views
  Json summary = geometry::parse_json<Json>(geometry::read_file(file, largest));
  if (summary.is_object()) return summary;
  throw Error(ErrorKind::bad_file,
              file.string() +
                  ": is not a package's summary, but no JSON or nested too deep; name the folder "
                  "of a mission package");
}

std::vector<geometry::View> views_of(const run::SurveyRecord& record) {
  std::vector<geometry::View> views;
  for (const run::JudgedView& judged : record.views) views.push_back(judged.surveyed.view);
  return views;
}

Json view_summary(std::size_t number, const run::JudgedView& judged) {
  const survey::SurveyedView& view = judged.surveyed;
  return {{"view", number},
          {"position", json_of(view.view.position)},
          {"direction", json_of(view.view.direction)},
          {"returns", view.returns},
          {"points_new", view.step.points_new},
          {"points", view.points},
          {"frontiers", view.step.frontiers},
          {"coverage", judged.coverage},
          {"planning_time_s", view.planning_time},
          {"planning_time_parts_s", json_of(view.step.times)},
          {"sensing_time_s", view.sensing_time},
          {"distance_m", view.distance}};
}

std::vector<Eigen::Vector3d> sensor_positions(const run::SurveyRecord& record) {
  std::vector<Eigen::Vector3d> positions;
  for (const run::JudgedView& judged : record.views) {
    positions.push_back(judged.surveyed.view.position);
  }
  return positions;
}

}  // namespace

std::string views_csv(const run::SurveyRecord& record) {
  std::string csv =
      "view,x,y,z,direction_x,direction_y,direction_z,returns,points_new,points,frontiers,"
      "coverage,distance_m\n";
  for (std::size_t i = 0; i < record.views.size(); ++i) {
    const run::JudgedView& judged = record.views[i];
    const survey::SurveyedView& view = judged.surveyed;
    csv += std::to_string(i);
    for (const Eigen::Vector3d& vector : {view.view.position, view.view.direction}) {
      for (int axis = 0; axis < 3; ++axis) csv.append(",").append(file::exact_text(vector[axis]));
    }
    for (const std::size_t count :
         {view.returns, view.step.points_new, view.points, view.step.frontiers}) {
      csv.append(",").append(std::to_string(count));
    }
    csv.append(",").append(file::exact_text(judged.coverage));
    csv.append(",").append(file::exact_text(view.distance)).append("\n");
  }
  return csv;
}

std::string trajectory_tum(const run::SurveyRecord& record) {
  std::string tum = "# timestamp tx ty tz qx qy qz qw\n";
  for (std::size_t i = 0; i < record.views.size(); ++i) {
    const Eigen::Isometry3d world_from_camera =
        geometry::camera_pose(record.views[i].surveyed.view);
    const Eigen::Vector3d& position = world_from_camera.translation();
    const Eigen::Quaterniond turn(world_from_camera.linear());
    tum += std::to_string(i);
    for (const double number :
         {position.x(), position.y(), position.z(), turn.x(), turn.y(), turn.z(), turn.w()}) {
      tum.append(" ").append(file::exact_text(number));
    }
    tum += "\n";
  }
  return tum;
}

std::vector<survey::PartTime> planning_time_by_part(const run::SurveyRecord& record) {
  std::vector<survey::PartTime> sums;
  for (const run::JudgedView& judged : record.views) {
    for (const auto& [part, seconds] : judged.surveyed.step.times) {
      const auto sum = std::ranges::find(sums, part, &survey::PartTime::part);
      if (sum == sums.end()) {
        sums.push_back({part, seconds});
      } else {
        sum->seconds += seconds;
      }
    }
  }
  return sums;
}

std::string summary_json(const file::Mission& mission, const run::SurveyRecord& record,
                         const CoverageFigures& coverage,
                         const std::optional<SurveyMission>& flight) {
  Json summary{{"mission", mission.name},
               {"planner", value_text(mission, "planner.name")},
               {"preset", value_text(mission, "planner.preset")},
               {"seed", record.seed},
               {"threads", record.threads},
               {"version", version},
               {"complete", record.is_complete()},
               {"stop_reason", run::name_of(record.stop_reason)},
               {"views", record.views.size()},
               {"points", record.cloud.size()},
               {"coverage", coverage.all},
               {"coverage_visible", json_of(coverage.visible)},
               {"coverage_ceiling", json_of(coverage.ceiling)},
               {"planning_time_s", record.planning_time()},
               {"planning_time_parts_s", json_of(planning_time_by_part(record))},
               {"sensing_time_s", record.sensing_time()},
               {"distance_m", record.distance()},
               {"belief", belief_summary(record)}};
  if (flight && flight->failure.empty()) {
    summary["route_length_m"] = flight->route.length;
    summary["min_clearance_m"] = flight->route.min_clearance;
    summary["flight"] = flight_summary(*record.flown, *flight);
  } else if (flight) {
    summary["flight"] = {{"pad", json_of(record.flown->pad)}, {"failure", flight->failure}};
  }
  summary["settings"] = settings(mission);
  summary["per_view"] = Json::array();
  for (std::size_t i = 0; i < record.views.size(); ++i) {
    summary["per_view"].push_back(view_summary(i, record.views[i]));
  }
  return file::json_text(summary);
}

std::optional<SurveyMission> stage_package(const file::Mission& mission,
                                           const run::SurveyRecord& record,
                                           const CoverageFigures& coverage, unsigned threads,
                                           geometry::OutputFolder& folder, std::stop_token stop) {
  folder.replace([](std::string_view name) {
    return name == free_space_name || name == fly_test_name || is_flight_file(name);
  });
  const double radius = 2.0 * mission.planner.see.resolution_radius;
  const std::vector<Eigen::Vector3f> normals =
      cloud_normals(record.cloud, sensor_positions(record), radius, threads);
  geometry::write_cloud(folder.stage("cloud.ply"), {.positions = record.cloud.positions,
                                                    .normals = normals,
                                                    .views = record.cloud.views,
                                                    .colours = {}});
  if (record.belief) {
    geometry::write_cloud(folder.stage("coverage.ply"), columns_of(coverage_map(*record.belief)));
  }
  folder.write("views.csv", views_csv(record));
  folder.write("trajectory.tum", trajectory_tum(record));
  std::optional<SurveyMission> flight;
  if (record.flown) {
    std::ostringstream free_space;
    record.flown->measured->write(free_space);
    folder.write(free_space_name, free_space.str());
    flight = SurveyMission{};
    try {
      flight->route =
          plan_flight(mission, *record.flown->measured, record.flown->pad, views_of(record));
      if (flight->route.sorties.empty() && !flight->route.unreached.empty()) {
        const flight::Unreached& first = flight->route.unreached.front();
        throw Error(ErrorKind::bad_config, "no view can be flown to; view " +
                                               std::to_string(first.station.view_index) + ": " +
                                               first.reason);
      }
      flight->files =
          stage_flight(mission, flight->route, *record.flown->measured, package_formats(), folder);
    } catch (const Error& error) {
      // The survey itself shall not be lost.
      flight->failure =
          stop.stop_requested() ? "interrupted; skycap export makes it" : error.what();
    }
  }
  // Last, so that whoever sees the summary sees the rest.
  folder.write(summary_name, summary_json(mission, record, coverage, flight));
  return flight;
}

PackageSummary read_package_summary(const std::filesystem::path& folder,
                                    const std::vector<file::KeyOverride>& overrides) {
  const std::filesystem::path file = folder / summary_name;
  geometry::finish_commit(folder);
  try {
    const Json json = read_summary(file);
    PackageSummary summary;
    summary.mission = mission_of(json.at("settings"), file, overrides);
    if (json.contains("flight")) {
      summary.pad = summary.mission.flight.takeoff.value_or(vector_of(json["flight"].at("pad")));
      geometry::require_place(*summary.pad, file.string() + ": flight.pad");
    }
    for (const Json& view : json.at("per_view")) {
      summary.views.push_back({vector_of(view.at("position")), vector_of(view.at("direction"))});
      const std::string place =
          file.string() + ": per_view[" + std::to_string(summary.views.size() - 1) + "].";
      geometry::require_place(summary.views.back().position, place + "position");
      geometry::require_direction(summary.views.back().direction, place + "direction");
    }
    return summary;
  } catch (const Json::exception& error) {
    fail(file, std::string("is not a package's summary (") + error.what() + ")");
  }
}

bool is_complete_result(const std::filesystem::path& json_file) {
  try {
    const Json json = geometry::parse_json<Json>(geometry::read_file(json_file));
    return json.is_object() && json.value("complete", Json()) == Json(true);
  } catch (const Error&) {
    return false;  // there is none
  }
}

PackagedSurvey read_package(const std::filesystem::path& folder,
                            const std::vector<file::KeyOverride>& overrides) {
  PackageSummary summary = read_package_summary(folder, overrides);
  if (!summary.pad) {
    fail(folder / summary_name, "is of a survey without a vehicle; plan it with flight.vehicle");
  }
  const std::filesystem::path space_file = folder / free_space_name;
  std::ifstream space(space_file, std::ios::binary);
  if (!space) fail(space_file, "cannot be read; plan the mission again");
  return {std::move(summary.mission), std::move(summary.views), *summary.pad,
          flight::MeasuredSpace::read(space, space_file.string())};
}

}  // namespace skycap::missions::package
