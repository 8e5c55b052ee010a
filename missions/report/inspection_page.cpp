#include "missions/report/inspection_page.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <nlohmann/json.hpp>

#include "flight/export/trajectory_file.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/file.h"
#include "missions/package/package.h"
#include "missions/package/profile_file.h"
#include "missions/report/cloud_code.h"
#include "missions/report/page.h"
#include "missions/report/profile_data.h"
#include "missions/report/scene_outline.h"
#include "missions/report/verdict.h"
#include "missions/support/json_text.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* structure_name = "structure.ply";
constexpr const char* poses_name = "camera.tum";

Json inspection_verdict(const Json& summary) {
  const Json& inspection = summary.at("inspection");
  const bool meets_goal = inspection.at("meets_goal").get<bool>();
  Verdict verdict{.is_complete = summary.at("complete").get<bool>(),
                  .because = "continuous flight without stops",
                  .lights = {}};
  verdict.lights.push_back({"Attainable points seen", "inspection.share_of_attainable", "share",
                            inspection.at("share_of_attainable"), meets_goal ? "green" : "amber",
                            "green: the required fraction"});
  verdict.lights.push_back({"Points seen", "inspection.evaluation.incidence.share", "share",
                            inspection.at("evaluation").at("incidence").at("share")});
  verdict.lights.push_back({"Minimum clearance (verified)", "inspection.verified_clearance_m",
                            "metres", inspection.at("verified_clearance_m"), "green",
                            "green: at least the required clearance"});
  verdict.lights.push_back(
      {"Inspection", "inspection.duration_s", "minutes", inspection.at("duration_s")});
  if (const Json& flown = inspection.at("flown"); flown.is_object()) {
    verdict.lights.push_back({"Points seen from the route files", "inspection.flown.incidence",
                              "share", flown.at("incidence")});
    verdict.lights.push_back(
        {"Deviation of the flown curve (bound)", "inspection.flown.deviation_bound_m", "metres",
         flown.at("deviation_bound_m"), "green", "green: at most the allowed deviation"});
    verdict.lights.push_back({"Flight with route files", "flight.route.duration_s", "minutes",
                              summary.at("flight").at("route").at("duration_s")});
  }
  return to_json(verdict);
}

/// Returns the camera poses for the replay, about one per second.
Json pieces_json(const fs::path& file) {
  Json pieces = Json::array();
  if (!is_there(file)) return pieces;
  constexpr std::size_t step = 10;
  const std::vector<flight::TimedPose> poses = flight::read_tum(geometry::read_file(file));
  for (std::size_t i = 0; i < poses.size(); i += step) {
    const Eigen::Isometry3d& pose = poses[i].world_from_camera;
    pieces.push_back({{"time_s", poses[i].time},
                      {"position", support::to_json(Eigen::Vector3d(pose.translation()))},
                      {"direction", support::to_json(Eigen::Vector3d(pose.linear().col(2)))}});
  }
  return pieces;
}

}  // namespace

std::string inspection_page(const ResultFinder& results, std::size_t max_points) {
  const fs::path file = results(package::summary_name);
  const Json summary = read_results(file);
  try {
    geometry::AttributedCloud structure;
    if (const fs::path cloud = results(structure_name); is_there(cloud)) {
      structure = geometry::read_cloud(cloud);
    }
    // Two colours: points that are seen, and others.
    std::vector<std::array<std::uint8_t, 3>> palette;
    std::vector<std::uint16_t> colours;
    for (const auto& colour : structure.colours) {
      const auto found = std::ranges::find(palette, colour);
      colours.push_back(static_cast<std::uint16_t>(found - palette.begin()));
      if (found == palette.end()) palette.push_back(colour);
    }
    std::vector<CloudAttribute> attributes;
    if (!colours.empty()) attributes.push_back({"colour", colours});
    const Json data = {{"kind", "inspection"},
                       {"title", summary.value("mission", std::string())},
                       {"verdict", inspection_verdict(summary)},
                       {"summary", summary},
                       {"scene", scene_outline(summary, file.string())},
                       {"palette", palette},
                       {"piece", "image"},
                       {"pieces", pieces_json(results(poses_name))},
                       {"profile", profile_data(results)},
                       {"files", files_json({package::summary_name, "inspection.csv", "corners.csv",
                                             "setpoints.enu.csv", "setpoints.ned.csv", poses_name,
                                             structure_name, "mission.kmz", "mission.plan",
                                             "mission.waypoints", package::profile_name},
                                            results)}};
    return page_text(data.at("title"), data,
                     {{"measured", encode_cloud(structure.positions, attributes, max_points)}});
  } catch (const Json::exception& error) {
    reject_results(file, error.what());
  }
}

}  // namespace skycap::missions::report
