#include "missions/report/survey_report.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "flight/clearance/free_boundary.h"
#include "flight/export/geodesy.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/parallel.h"
#include "missions/package/coverage_map.h"
#include "missions/package/field_sheet.h"
#include "missions/package/fleet/timetable_file.h"
#include "missions/package/former_fields.h"
#include "missions/package/package.h"
#include "missions/package/profile_file.h"
#include "missions/report/page.h"
#include "missions/report/point_figures.h"
#include "missions/report/profile_data.h"
#include "missions/report/scene_outline.h"
#include "missions/report/verdict.h"
#include "missions/support/json_text.h"
#include "missions/support/number_text.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

geometry::AttributedCloud cloud_if_there(const fs::path& file) {
  return is_there(file) ? geometry::read_cloud(file) : geometry::AttributedCloud{};
}

/// Returns the files in the folder other than the summary.
Json collect_files(const Json& summary, const ResultFinder& results) {
  std::vector<std::string> names = {
      "cloud.ply",      "coverage.ply",           "true_coverage.ply",       "views.csv",
      "trajectory.tum", package::free_space_name, package::field_sheet_name, package::profile_name};
  const auto add_all = [&](const Json::json_pointer& pointer, const char* field) {
    if (!summary.contains(pointer) || !summary[pointer].is_array()) return;
    for (const Json& entry : summary[pointer]) {
      const Json& name = *field == '\0' ? entry : entry.at(field);
      if (name.is_string()) names.push_back(name.get<std::string>());
    }
  };
  add_all(Json::json_pointer("/flight/files"), "name");
  add_all(Json::json_pointer("/flight/return/parameters"), "");
  const Json::json_pointer vehicles("/flight/fleet/vehicles");
  if (summary.contains(vehicles)) {
    names.emplace_back(package::timetable_name);
    for (std::size_t i = 0; i < summary[vehicles].size(); ++i) add_all(vehicles / i / "files", "");
  }
  return files_json(names, results);
}

/// Returns latitude, longitude and ellipsoidal height of the holes' centres.
Json hole_positions(const Json& summary, const flight::FlightOptions& options) {
  Json hole_list = Json::array();
  const Json::json_pointer holes("/surface/holes");
  if (!options.is_georeferenced || !summary.contains(holes)) return hole_list;
  const flight::LocalFrame frame(options.site.origin);
  for (const Json& hole : summary[holes]) {
    const Json& centre = hole.at("centre");
    const flight::GeodeticPoint geodetic = frame.to_geodetic(
        {centre.at(0).get<double>(), centre.at(1).get<double>(), centre.at(2).get<double>()});
    hole_list.push_back({geodetic.latitude_deg, geodetic.longitude_deg, geodetic.height});
  }
  return hole_list;
}

/// Returns the noise estimated by the planner, or else that of the mission.
PointNoise read_noise(const Json& summary, const sim::NoiseConfig& stated) {
  const Json::json_pointer learnt("/estimate/noise_m");
  const bool is_learnt = summary.contains(learnt) && summary[learnt].is_number() &&
                         summary[learnt].get<double>() > 0.0;
  return {is_learnt ? summary[learnt].get<double>() : stated.sigma,
          stated.direction == sim::NoiseDirection::along_ray};
}

PageCloud measured_cloud(const geometry::AttributedCloud& cloud,
                         std::span<const std::uint16_t> states,
                         std::span<const std::uint16_t> incidence, std::size_t max_points) {
  const std::vector<std::uint16_t> views = view_numbers(cloud);
  std::vector<CloudAttribute> attributes;
  if (!views.empty()) attributes.push_back({"view", views});
  attributes.push_back({"state", states});
  if (!incidence.empty()) attributes.push_back({"incidence", incidence});
  return {"measured", encode_cloud(cloud.positions, attributes, max_points)};
}

/// Returns the uncovered surface patches.
PageCloud missing_cloud(const geometry::AttributedCloud& map, std::size_t max_points) {
  const std::vector<std::uint16_t> all = map_states(map);
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::uint16_t> states;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i] == 0) continue;
    positions.push_back(map.positions[i]);
    states.push_back(all[i]);
  }
  const CloudAttribute attribute{"state", states};
  return {"missing", encode_cloud(positions, {&attribute, 1}, max_points)};
}

/// Returns the boundary of observed free space, with a limited number of faces selected evenly
/// along a space-filling curve.
PageCloud free_cloud(const fs::path& file) {
  constexpr std::size_t max_faces = 50'000;
  std::vector<Eigen::Vector3f> faces;
  if (is_there(file)) {
    std::ifstream stream = geometry::open_stream(file);
    faces = flight::free_boundary(stream, file.string());
  }
  return {"free", encode_cloud(faces, {}, max_faces)};
}

/// Returns half the maximum distance between connected surface patches [m].
double read_reach(const Json& summary) {
  const Json::json_pointer link("/surface/link_m");
  return summary.contains(link) && summary[link].is_number() ? summary[link].get<double>() / 2.0
                                                             : 0.0;
}

}  // namespace

std::string live_page(const std::string& summary_text, const session::SurveyOptions& survey,
                      const scene::SceneOptions& scene, session::SurveyRecord so_far,
                      const NextView& next) {
  constexpr std::size_t max_points = 250'000;
  const package::CoverageFigures unknown{so_far.coverage(), {}, {}};
  const Json summary = Json::parse(summary_text);
  const auto patches = package::known_surface(so_far, unknown);
  const geometry::AttributedCloud map = package::coverage_map(patches);
  geometry::AttributedCloud cloud;
  cloud.positions = std::move(so_far.cloud.positions);
  cloud.views = std::move(so_far.cloud.views);
  Json shown = verdict(summary);
  const bool goes_on = next.view.has_value();
  shown["answer"] = goes_on ? "running" : "over";
  shown["because"] = support::counted(so_far.views.size(), "scan") + " so far" +
                     (goes_on ? "" : "; run skycap finish to write the package");
  shown["light"] = "none";
  const auto name = summary.at("mission").get<std::string>();
  const Json data = {{"kind", "survey"},
                     {"title", name},
                     {"verdict", shown},
                     {"summary", summary},
                     {"scene", scene_outline(survey, scene, survey.flight.takeoff)},
                     {"hole_places", hole_positions(summary, survey.flight)},
                     {"live",
                      {{"position", goes_on ? support::to_json(next.view->position) : Json()},
                       {"direction", goes_on ? support::to_json(next.view->direction) : Json()},
                       {"way", support::to_json(next.path)}}}};
  return page_text(
      name, data,
      {measured_cloud(cloud, point_states(cloud, map, read_reach(summary)), {}, max_points),
       missing_cloud(map, max_points)});
}

std::string survey_report(const ResultFinder& results, std::size_t max_points) {
  const fs::path summary_file = results(package::summary_name);
  const std::string text = results_text(summary_file);
  try {
    const package::PackageSummary survey =
        package::parse_package_summary(text, summary_file.string());
    Json summary = geometry::parse_json<Json>(text);
    package::use_current_fields(summary);
    const geometry::AttributedCloud cloud = cloud_if_there(results("cloud.ply"));
    const geometry::AttributedCloud map = cloud_if_there(results("coverage.ply"));
    const std::vector<std::uint16_t> incidence = incidence_steps(cloud, survey.views);
    const fs::path free_space = results(package::free_space_name);
    std::vector<PageCloud> clouds(3);
    Json accuracy;
    geometry::parallel_for(2, survey.mission.run.threads, [&](std::size_t part) {
      if (part == 0) {
        const std::vector<std::uint16_t> states = point_states(cloud, map, read_reach(summary));
        clouds[0] = measured_cloud(cloud, states, incidence, max_points);
        return;
      }
      clouds[1] = missing_cloud(map, max_points);
      clouds[2] = free_cloud(free_space);
      const std::vector<float> errors = surface_errors(
          cloud, incidence, read_noise(summary, survey.mission.sensor().camera.noise),
          survey.mission.evaluation().registration_distance);
      accuracy = accuracy_json(incidence, ranges(cloud, survey.views), errors);
    });
    const Json data = {
        {"kind", "survey"},
        {"title", summary.value("mission", std::string())},
        {"verdict", verdict(summary)},
        {"summary", summary},
        {"scene", scene_outline(survey.mission.survey(), survey.mission.scene(), survey.pad)},
        {"hole_places", hole_positions(summary, survey.mission.flight())},
        {"accuracy", std::move(accuracy)},
        {"profile", profile_data(results)},
        {"files", collect_files(summary, results)}};
    return page_text(data.at("title"), data, clouds);
  } catch (const Json::exception& error) {
    reject_results(summary_file, error.what());
  }
}

}  // namespace skycap::missions::report
