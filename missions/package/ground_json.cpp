#include "missions/package/ground_json.h"

#include <fmt/format.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/pose/world.h"
#include "missions/support/json_text.h"

namespace skycap::missions::package {

using flight::GroundSource;
using flight::LandingSurface;
using Json = nlohmann::ordered_json;

Json landing_surfaces_json(std::span<const LandingSurface> landing_surfaces) {
  Json list = Json::array();
  for (const LandingSurface& ground : landing_surfaces) {
    list.push_back({{"place", support::to_json(ground.position)},
                    {"slope_deg", ground.slope * geometry::degrees_per_radian},
                    {"unevenness_m", ground.unevenness},
                    {"rise_m", ground.rise},
                    {"known", to_string(ground.source)}});
  }
  return list;
}

std::vector<LandingSurface> measured_landing_surfaces(const Json& list, const std::string& name) {
  std::vector<LandingSurface> landing_surfaces;
  for (const Json& json : list) {
    if (json.at("known") != Json(to_string(GroundSource::measured))) continue;
    const Eigen::Vector3d figures(json.at("slope_deg").get<double>(),
                                  json.at("unevenness_m").get<double>(),
                                  json.at("rise_m").get<double>());
    geometry::require_valid_position(figures, name + ": flight.grounds");
    landing_surfaces.push_back({support::to_vector(json.at("place")),
                                figures.x() * geometry::radians_per_degree, figures.y(),
                                figures.z(), GroundSource::measured});
    geometry::require_valid_position(landing_surfaces.back().position, name + ": flight.grounds");
  }
  return landing_surfaces;
}

std::string landing_surfaces_text(std::span<const LandingSurface> landing_surfaces) {
  std::string text;
  for (const LandingSurface& ground : landing_surfaces) {
    text += fmt::format("{}slope {:.1f} degrees {}", text.empty() ? "  pad       " : ", ",
                        ground.slope * geometry::degrees_per_radian, to_string(ground.source));
  }
  return text.empty() ? "" : text + "\n";
}

}  // namespace skycap::missions::package
