#include "missions/report/photo_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "flight/export/text.h"
#include "geometry/io/file.h"
#include "missions/package/package.h"
#include "missions/package/profile_file.h"
#include "missions/report/cloud_code.h"
#include "missions/report/page.h"
#include "missions/report/point_figures.h"
#include "missions/report/profile_data.h"
#include "missions/report/scene_outline.h"
#include "missions/report/verdict.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// Name of the surface map, see photo::surface_table().
constexpr const char* surface_map_name = "photo_surface.csv";

/// Thresholds of the rating of the expected completeness of the attainable surface.
constexpr double good_completeness = 0.95, fair_completeness = 0.85;

constexpr std::array<std::string_view, 3> surface_classes{"good", "weak", "missing"};

/// Columns of the surface map. Values are NaN where the table has none.
struct SurfaceMap {
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::uint16_t> classes;
  std::vector<float> observations, gsd, parallax, incidence;
};

SurfaceMap read_surface_map(const fs::path& file) {
  SurfaceMap map;
  if (!is_there(file)) return map;
  const std::string text = geometry::read_file(file);
  const std::vector<std::string> lines = flight::split_lines(text);
  const auto number = [&](const std::string& field) {
    if (field.empty()) return std::nanf("");
    const auto value = flight::to_number(field);
    if (!value) reject_results(file, "\"" + field + "\" is not a number");
    return static_cast<float>(*value);
  };
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (lines[i].empty()) continue;
    const std::vector<std::string> fields = flight::split(lines[i], ',');
    constexpr std::size_t columns = 9;
    if (fields.size() != columns) {
      reject_results(file, "line " + std::to_string(i + 1) + " must have 9 fields");
    }
    const auto found = std::ranges::find(surface_classes, fields[3]);
    if (found == surface_classes.end()) reject_results(file, "unknown class " + fields[3]);
    map.positions.emplace_back(number(fields[0]), number(fields[1]), number(fields[2]));
    map.classes.push_back(static_cast<std::uint16_t>(found - surface_classes.begin()));
    map.observations.push_back(number(fields[5]));
    map.gsd.push_back(number(fields[6]));
    map.parallax.push_back(number(fields[7]));
    map.incidence.push_back(number(fields[8]));
  }
  return map;
}

/// Range of the colours of a map. Value 0 of the attribute means no value, 1 to 255 cover the
/// range.
struct MapScale {
  double low = 0.0, high = 1.0;

  std::vector<std::uint16_t> attribute(const std::vector<float>& values) const {
    constexpr double steps = 254.0;
    std::vector<std::uint16_t> encoded;
    for (const float value : values) {
      const double share = std::clamp((value - low) / (high - low), 0.0, 1.0);
      encoded.push_back(std::isnan(value)
                            ? std::uint16_t{0}
                            : static_cast<std::uint16_t>(1 + std::lround(steps * share)));
    }
    return encoded;
  }
};

std::vector<std::uint16_t> incidence_attribute(const std::vector<float>& degrees) {
  std::vector<std::uint16_t> steps;
  for (const float value : degrees) {
    steps.push_back(std::isnan(value) ? no_incidence
                                      : static_cast<std::uint16_t>(value / incidence_step_deg));
  }
  return steps;
}

Json histogram_json(const std::vector<float>& values, double low, double high, std::size_t bins) {
  return {{"low", low}, {"high", high}, {"counts", histogram(values, low, high, bins)}};
}

Json verdict_json(const Json& summary) {
  const Json& photo = summary.at("photo");
  const Json& figures = photo.at("figures");
  const double completeness = figures.at("expected_completeness_of_attainable").get<double>();
  Verdict verdict{.is_complete = summary.at("complete").get<bool>(),
                  .because = std::to_string(photo.at("photos").get<std::size_t>()) +
                             " photos with " + photo.at("camera").get<std::string>(),
                  .lights = {}};
  verdict.lights.push_back({"Expected completeness of the attainable surface",
                            "photo.figures.expected_completeness_of_attainable", "share",
                            completeness,
                            completeness >= good_completeness   ? "green"
                            : completeness >= fair_completeness ? "amber"
                                                                : "red",
                            "green: at least 95%, amber: at least 85%"});
  verdict.lights.push_back({"Expected completeness of the exposed surface",
                            "photo.figures.expected_completeness", "share",
                            figures.at("expected_completeness")});
  verdict.lights.push_back({"Photos", "photo.photos", "count", photo.at("photos")});
  if (summary.contains("flight")) {
    const Json& route = summary.at("flight").at("route");
    verdict.lights.push_back({"Minimum clearance (verified)", "flight.route.min_clearance_m",
                              "metres", route.at("min_clearance_m"), "green",
                              "green: every leg keeps the required clearance"});
    verdict.lights.push_back(
        {"Flight", "flight.route.duration_s", "minutes", route.at("duration_s")});
    const std::size_t missed = route.at("skipped_views").size();
    verdict.lights.push_back({"Photos not in the flight", "flight.route.skipped_views.length",
                              "count", missed, missed == 0 ? "green" : "amber", "green: none"});
  }
  return to_json(verdict);
}

}  // namespace

std::string photo_page(const ResultFinder& results, std::size_t max_points) {
  const fs::path file = results(package::summary_name);
  const Json summary = read_results(file);
  try {
    const SurfaceMap map = read_surface_map(results(surface_map_name));
    const double gsd = summary.at("photo").at("gsd_m").get<double>();
    const MapScale gsd_scale{0.0, 2.0 * gsd}, parallax_scale{0.0, 40.0}, count_scale{0.0, 10.0};
    const std::vector<std::uint16_t> gsds = gsd_scale.attribute(map.gsd);
    const std::vector<std::uint16_t> parallaxes = parallax_scale.attribute(map.parallax);
    const std::vector<std::uint16_t> counts = count_scale.attribute(map.observations);
    const std::vector<std::uint16_t> incidence = incidence_attribute(map.incidence);
    const std::vector<CloudAttribute> attributes{{"quality", map.classes},
                                                 {"gsd", gsds},
                                                 {"observations", counts},
                                                 {"parallax", parallaxes},
                                                 {"incidence", incidence}};
    const auto scale = [](const char* title, const MapScale& range, const char* form) {
      return Json{{"title", title}, {"low", range.low}, {"high", range.high}, {"form", form}};
    };
    const Json data = {
        {"kind", "photos"},
        {"title", summary.value("mission", std::string())},
        {"verdict", verdict_json(summary)},
        {"summary", summary},
        {"scene", scene_outline(summary, file.string())},
        {"maps",
         {{"gsd", scale("ground sampling distance", gsd_scale, "millimetres")},
          {"observations", scale("photos of a point", count_scale, "count")},
          {"parallax", scale("maximum parallax of stereo partners", parallax_scale, "degrees")}}},
        {"histograms",
         {{"gsd_mm", histogram_json(map.gsd, 0.0, 2.0 * gsd, 40)},
          {"observations", histogram_json(map.observations, 0.0, 30.0, 30)},
          {"parallax_deg", histogram_json(map.parallax, 0.0, 40.0, 20)},
          {"incidence_deg", histogram_json(map.incidence, 0.0, 90.0, 18)}}},
        {"profile", profile_data(results)},
        {"files", files_json({package::summary_name, "photos.csv", "geo.txt", surface_map_name,
                              "control_points.csv", "field_sheet.html", package::profile_name},
                             results)}};
    return page_text(data.at("title"), data,
                     {{"measured", encode_cloud(map.positions, attributes, max_points)}});
  } catch (const Json::exception& error) {
    reject_results(file, error.what());
  }
}

}  // namespace skycap::missions::report
