#include "missions/report/cloud_page.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/io/cloud_io.h"
#include "missions/report/page.h"
#include "missions/report/point_figures.h"
#include "missions/report/results.h"
#include "missions/report/scene_outline.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;

std::string count_text(std::size_t count) { return std::to_string(count) + " points"; }

}  // namespace

std::string cloud_page(const std::filesystem::path& file) {
  const geometry::AttributedCloud cloud = geometry::read_cloud(file);
  const std::vector<std::uint16_t> views = view_numbers(cloud);
  std::vector<CloudAttribute> attributes;
  if (!views.empty()) attributes.push_back({"view", views});
  const std::string name = file.filename().string();
  const Json data = {
      {"kind", "cloud"}, {"title", name}, {"facts", {count_text(cloud.positions.size())}}};
  return page_text(
      name, data, {{"measured", encode_cloud(cloud.positions, attributes, default_report_points)}});
}

std::string mission_page(const file::Mission& mission, std::span<const Eigen::Vector3f> surface,
                         const std::optional<Eigen::Vector3d>& pad) {
  const Json data = {
      {"kind", "mission"},
      {"title", mission.name},
      {"facts", {mission.scene.model, "nothing is measured yet: the simulator's model"}},
      {"scene", scene_outline(mission, pad)}};
  return page_text(mission.name, data,
                   {{"model", encode_cloud(surface, {}, default_report_points)}});
}

}  // namespace skycap::missions::report
