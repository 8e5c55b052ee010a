#include "missions/package/ground_json.h"

#include <fmt/format.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/place/world.h"
#include "missions/support/json_text.h"

namespace skycap::missions::package {

using flight::GroundSource;
using flight::PadGround;
using Json = nlohmann::ordered_json;

Json grounds_json(std::span<const PadGround> grounds) {
  Json list = Json::array();
  for (const PadGround& ground : grounds) {
    list.push_back({{"place", support::json_of(ground.place)},
                    {"slope_deg", ground.slope * geometry::degrees_per_radian},
                    {"unevenness_m", ground.unevenness},
                    {"rise_m", ground.rise},
                    {"known", name_of(ground.source)}});
  }
  return list;
}

std::vector<PadGround> measured_grounds(const Json& list, const std::string& name) {
  std::vector<PadGround> grounds;
  for (const Json& json : list) {
    if (json.at("known") != Json(name_of(GroundSource::measured))) continue;
    const Eigen::Vector3d figures(json.at("slope_deg").get<double>(),
                                  json.at("unevenness_m").get<double>(),
                                  json.at("rise_m").get<double>());
    geometry::require_place(figures, name + ": flight.grounds");
    grounds.push_back({support::vector_of(json.at("place")),
                       figures.x() * geometry::radians_per_degree, figures.y(), figures.z(),
                       GroundSource::measured});
    geometry::require_place(grounds.back().place, name + ": flight.grounds");
  }
  return grounds;
}

std::string grounds_text(std::span<const PadGround> grounds) {
  std::string text;
  for (const PadGround& ground : grounds) {
    text += fmt::format("{}slope {:.1f} degrees {}", text.empty() ? "  pad       " : ", ",
                        ground.slope * geometry::degrees_per_radian, name_of(ground.source));
  }
  return text.empty() ? "" : text + "\n";
}

}  // namespace skycap::missions::package
