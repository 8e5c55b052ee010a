#include "missions/report/flown_page.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "geometry/angle.h"
#include "geometry/io/cloud_io.h"
#include "missions/package/settings.h"
#include "missions/report/cloud_code.h"
#include "missions/report/page.h"
#include "missions/report/point_figures.h"
#include "missions/report/scene_outline.h"
#include "missions/report/verdict.h"
#include "missions/support/json_text.h"
#include "missions/support/number_text.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

std::size_t count_flown_legs(const Json& legs) {
  std::size_t flown = 0;
  for (const Json& leg : legs) flown += leg.at("flown").get<bool>() ? 1 : 0;
  return flown;
}

/// Rates a distance against the required clearance.
void add_distance(const char* name, const char* figure, const Json& distance, const Json& required,
                  Verdict& verdict) {
  const bool is_kept = distance.get<double>() >= required.get<double>();
  verdict.lights.push_back({name, figure, "metres", distance, is_kept ? "green" : "red",
                            "green: at least the required clearance"});
}

Json flown_verdict(const Json& summary) {
  const Json& captures = summary.at("captures");
  const Json& legs = summary.at("legs");
  const bool has_plan = summary.at("has_plan").get<bool>();
  const std::size_t missed = captures.at("missed"), flown = count_flown_legs(legs);
  Verdict verdict{.is_complete = !has_plan || (missed == 0 && flown == legs.size()),
                  .because = has_plan ? std::to_string(flown) + " of " +
                                            support::counted(legs.size(), "leg") + " flown, " +
                                            support::counted(missed, "capture") + " missed"
                                      : "a flight without a plan",
                  .lights = {},
                  .else_light = "amber"};
  if (has_plan) {
    verdict.lights.push_back({"Missed captures", "captures.missed", "count", missed,
                              missed == 0 ? "green" : "amber", "green: none"});
  }
  const Json& clearance = summary.at("clearance");
  if (clearance.contains("min_cloud_distance_m")) {
    add_distance("Minimum distance to the measured cloud", "clearance.min_cloud_distance_m",
                 clearance["min_cloud_distance_m"], clearance.at("required_m"), verdict);
  } else if (clearance.contains("model")) {
    add_distance("Minimum distance to the model", "clearance.model.min_distance_m",
                 clearance["model"].at("min_distance_m"), clearance.at("required_m"), verdict);
  }
  if (const Json& coverage = summary.at("coverage"); coverage.is_object()) {
    const bool is_visible = coverage.at("flown").at("coverage_visible").is_number();
    verdict.lights.push_back(
        {is_visible ? "Visible surface covered" : "Surface covered",
         is_visible ? "coverage.flown.coverage_visible" : "coverage.flown.coverage", "share",
         coverage.at("flown").at(is_visible ? "coverage_visible" : "coverage")});
  } else if (const Json& photos = summary.at("photos"); photos.is_object()) {
    verdict.lights.push_back({"Expected completeness", "photos.flown.expected_completeness",
                              "share", photos.at("flown").at("expected_completeness")});
  }
  verdict.lights.push_back({"Flight", "duration_s", "minutes", summary.at("duration_s")});
  return to_json(verdict);
}

/// Returns the capture of the 3-D view at a pose, or null if its direction is unknown.
Json capture_piece(const Json& position, const Json& yaw_deg, const Json& pitch_deg) {
  if (!yaw_deg.is_number() || !pitch_deg.is_number()) return {};
  constexpr double degree = geometry::radians_per_degree;
  const double yaw = degree * yaw_deg.get<double>(), pitch = degree * pitch_deg.get<double>();
  const Eigen::Vector3d direction(std::sin(yaw) * std::cos(pitch), std::cos(yaw) * std::cos(pitch),
                                  std::sin(pitch));
  return {{"position", position}, {"direction", support::to_json(direction)}};
}

/// Returns the planned captures where they were flown, missed ones where they were planned, and the
/// captures without a plan.
Json capture_pieces(const Json& captures) {
  Json pieces = Json::array();
  for (const Json& capture : captures.at("list")) {
    const bool is_made = capture.at("made").get<bool>();
    Json piece =
        is_made
            ? capture_piece(capture.at("position"), capture.at("yaw_deg"), capture.at("pitch_deg"))
            : capture_piece(capture.at("planned_position"), capture.at("planned_yaw_deg"),
                            capture.at("planned_pitch_deg"));
    if (piece.is_null()) continue;
    piece["item"] = capture.at("item");
    piece["missed"] = capture.at("missed");
    piece["time_s"] = is_made ? capture.at("time_s") : Json();
    piece["error_m"] = is_made ? capture.at("error_m") : Json();
    pieces.push_back(std::move(piece));
  }
  for (const Json& capture : captures.at("unplanned")) {
    Json piece =
        capture_piece(capture.at("position"), capture.at("yaw_deg"), capture.at("pitch_deg"));
    piece["item"] = "not planned";
    piece["missed"] = false;
    piece["time_s"] = capture.at("time_s");
    piece["error_m"] = Json();
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

std::vector<std::string> flown_files(const Json& summary) {
  std::vector<std::string> names{"compare.json", "surface.ply"};
  if (const Json& patch = summary.at("patch"); patch.is_object()) {
    for (const Json& file : patch.at("files")) names.push_back(file.at("name"));
  }
  return names;
}

/// Returns the outline of the mission that was compared.
Json flown_outline(const Json& summary, const std::string& name) {
  const config::MissionSetup setup = package::mission_from_settings(summary.at("settings"), name);
  std::optional<Eigen::Vector3d> pad;
  if (const Json& takeoff = summary.at("takeoff"); takeoff.is_array()) {
    pad = Eigen::Vector3d(takeoff.at(0), takeoff.at(1), takeoff.at(2));
  }
  return scene_outline(setup.survey(), setup.scene(), pad);
}

/// Points of a coverage map in some states.
struct SurfacePart {
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::uint16_t> states;
};

/// Returns the covered and the uncovered surface, or the cloud if its coverage is unknown.
std::vector<PageCloud> surface_clouds(const geometry::AttributedCloud& surface,
                                      std::size_t max_points) {
  if (surface.colours.empty()) {
    return {{"measured", encode_cloud(surface.positions, {}, max_points)}};
  }
  const std::vector<std::uint16_t> states = map_states(surface);
  SurfacePart covered, missing;
  for (std::size_t i = 0; i < states.size(); ++i) {
    SurfacePart& part = states[i] == 0 ? covered : missing;
    part.positions.push_back(surface.positions[i]);
    part.states.push_back(states[i]);
  }
  const auto encode = [&](const SurfacePart& part) {
    const CloudAttribute attribute{"state", part.states};
    return encode_cloud(part.positions, {&attribute, 1}, max_points);
  };
  return {{"measured", encode(covered)}, {"missing", encode(missing)}};
}

}  // namespace

std::string flown_page(const ResultFinder& results, std::size_t max_points) {
  const fs::path file = results("compare.json");
  Json summary = read_results(file);
  try {
    geometry::AttributedCloud surface;
    if (const fs::path cloud = results("surface.ply"); is_there(cloud)) {
      surface = geometry::read_cloud(cloud);
    }
    if (summary.at("coverage").is_object()) {
      summary["surface"] = summary["coverage"].at("surface");
    }
    Json facts = {summary.at("log_kind"), "heights " + summary.at("heights").get<std::string>()};
    for (const Json& log : summary.at("logs")) facts.push_back("log " + log.get<std::string>());
    const Json data = {{"kind", "flown"},
                       {"title", summary.at("mission")},
                       {"facts", facts},
                       {"verdict", flown_verdict(summary)},
                       {"scene", flown_outline(summary, file.string())},
                       {"piece", "capture"},
                       {"pieces", capture_pieces(summary.at("captures"))},
                       {"files", files_json(flown_files(summary), results)},
                       {"summary", summary}};
    return page_text(data.at("title"), data, surface_clouds(surface, max_points));
  } catch (const Json::exception& error) {
    reject_results(file, error.what());
  }
}

}  // namespace skycap::missions::report
