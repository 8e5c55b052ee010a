#include "missions/report/survey_report.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "flight/export/geodesy.h"
#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "missions/derived/mission_flight.h"
#include "missions/package/package.h"
#include "missions/report/page.h"
#include "missions/report/point_figures.h"
#include "missions/report/scene_outline.h"
#include "missions/report/verdict.h"
#include "missions/scene/sha256.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

bool is_there(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored);
}

geometry::AttributedCloud cloud_if_there(const fs::path& file) {
  return is_there(file) ? geometry::read_cloud(file) : geometry::AttributedCloud{};
}

/// What the folder holds besides the summary, so that whoever has a file can see that it is the
/// one of the report.
Json files_of(const Json& summary, const ResultFinder& results) {
  std::vector<std::string> names = {"cloud.ply", "coverage.ply", "views.csv", "trajectory.tum",
                                    "free_space.bin"};
  const auto add_all = [&](const char* path, const char* field) {
    const Json::json_pointer pointer(path);
    if (!summary.contains(pointer) || !summary[pointer].is_array()) return;
    for (const Json& entry : summary[pointer]) {
      const Json& name = *field == '\0' ? entry : entry.at(field);
      if (name.is_string()) names.push_back(name.get<std::string>());
    }
  };
  add_all("/flight/files", "name");
  add_all("/flight/return/parameters", "");
  Json files = Json::array();
  for (const std::string& name : names) {
    // A summary may come from anywhere: no other folder's files.
    if (fs::path(name).filename() != name || !is_there(results(name))) continue;
    files.push_back({{"name", name},
                     {"bytes", fs::file_size(results(name))},
                     {"sha256", scene::sha256_of_file(results(name))}});
  }
  return files;
}

/// Latitude, longitude and ellipsoid height of the holes' centres.
Json hole_places(const Json& summary, const file::Mission& mission) {
  Json places = Json::array();
  const Json::json_pointer holes("/surface/holes");
  if (!derived::has_place(mission) || !summary.contains(holes)) return places;
  const flight::LocalFrame frame(derived::site_of(mission).origin);
  for (const Json& hole : summary[holes]) {
    const Json& centre = hole.at("centre");
    const flight::GeodeticPoint place = frame.to_geodetic(
        {centre.at(0).get<double>(), centre.at(1).get<double>(), centre.at(2).get<double>()});
    places.push_back({place.latitude_deg, place.longitude_deg, place.height});
  }
  return places;
}

/// How the cloud's points were seen, all of them, not only those that the page shows.
Json accuracy(std::span<const std::uint16_t> incidence, std::span<const float> range) {
  std::vector<float> degrees;
  for (const std::uint16_t step : incidence) {
    if (step == no_incidence) continue;
    degrees.push_back(static_cast<float>((step + 0.5) * incidence_step_deg));
  }
  constexpr std::size_t bins = 9;
  float farthest = 0.0F;
  for (const float one : range) farthest = std::max(farthest, one);
  return {{"incidence_deg",
           {{"low", 0.0}, {"high", 90.0}, {"counts", histogram(degrees, 0.0, 90.0, bins)}}},
          {"range_m",
           {{"low", 0.0},
            {"high", static_cast<double>(farthest)},
            {"counts", histogram(range, 0.0, static_cast<double>(farthest), 20)}}}};
}

PageCloud measured_cloud(const geometry::AttributedCloud& cloud,
                         std::span<const std::uint16_t> states,
                         std::span<const std::uint16_t> incidence, std::size_t most_points) {
  const std::vector<std::uint16_t> views = view_numbers(cloud);
  std::vector<CloudAttribute> attributes = {{"state", states}, {"incidence", incidence}};
  if (!views.empty()) attributes.push_back({"view", views});
  return {"measured", encode_cloud(cloud.positions, attributes, most_points)};
}

/// The pieces of surface that are not covered.
PageCloud missing_cloud(const geometry::AttributedCloud& map, std::size_t most_points) {
  const std::vector<std::uint16_t> all = map_states(map);
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::uint16_t> states;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i] == 0) continue;
    positions.push_back(map.positions[i]);
    states.push_back(all[i]);
  }
  const CloudAttribute attribute{"state", states};
  return {"missing", encode_cloud(positions, {&attribute, 1}, most_points)};
}

/// Half the distance at which pieces of surface hang together reaches from each to the next.
double reach_of(const Json& summary) {
  const Json::json_pointer link("/surface/link_m");
  return summary.contains(link) && summary[link].is_number() ? summary[link].get<double>() / 2.0
                                                             : 0.0;
}

}  // namespace

ResultFinder results_in(const fs::path& folder) {
  return [folder](const std::string& name) { return folder / name; };
}

std::string survey_report(const ResultFinder& results, std::size_t most_points) {
  constexpr std::size_t largest = std::size_t{256} << 20;  // a summary of a million views
  const fs::path summary_file = results(package::summary_name);
  const std::string text = geometry::read_file(summary_file, largest);
  try {
    const package::PackageSummary survey =
        package::parse_package_summary(text, summary_file.string());
    const Json summary = geometry::parse_json<Json>(text);
    const geometry::AttributedCloud cloud = cloud_if_there(results("cloud.ply"));
    const geometry::AttributedCloud map = cloud_if_there(results("coverage.ply"));
    const std::vector<std::uint16_t> states = point_states(cloud, map, reach_of(summary));
    const std::vector<std::uint16_t> incidence = incidence_steps(cloud, survey.views);
    const Json data = {{"kind", "survey"},
                       {"title", summary.value("mission", std::string())},
                       {"verdict", verdict(summary)},
                       {"summary", summary},
                       {"scene", scene_outline(survey.mission, survey.pad)},
                       {"hole_places", hole_places(summary, survey.mission)},
                       {"accuracy", accuracy(incidence, ranges(cloud, survey.views))},
                       {"files", files_of(summary, results)}};
    return page_text(
        data.at("title"), data,
        {measured_cloud(cloud, states, incidence, most_points), missing_cloud(map, most_points)});
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::bad_file,
                summary_file.string() + ": is not a package's summary (" + error.what() + ")");
  }
}

}  // namespace skycap::missions::report
