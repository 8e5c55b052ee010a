#include "missions/package/surface_json.h"

#include <nlohmann/json.hpp>

#include "missions/support/json_text.h"

namespace skycap::missions::package {
namespace {

using Json = nlohmann::ordered_json;

Json part_json(const CoveredPart& part) {
  return {{"name", part.name}, {"area_m2", part.area}, {"coverage", part.covered}};
}

}  // namespace

Json missing_json(const MissingSurface& missing, const char* known_by) {
  Json holes = Json::array();
  for (const Hole& hole : missing.holes) {
    holes.push_back({{"reason", to_string(hole.reason)},
                     {"area_m2", hole.area},
                     {"centre", support::to_json(hole.centre)},
                     {"normal", support::to_json(hole.normal)},
                     {"radius_m", hole.radius},
                     {"pieces", hole.num_patches},
                     {"nearest_view", hole.nearest_view},
                     {"view_distance_m", hole.view_distance}});
  }
  return {{"known_by", known_by},
          {"area_m2", missing.area},
          {"link_m", missing.link},
          {"least_hole_m2", missing.min_hole_area},
          {"holes", holes},
          {"smaller", {{"holes", missing.smaller}, {"area_m2", missing.smaller_area}}},
          {"rest_m2", missing.rest}};
}

Json targets_json(const std::vector<TargetCoverage>& targets) {
  Json list = Json::array();
  for (const TargetCoverage& target : targets) {
    Json json = part_json(target.object);
    json["within_m"] = target.radius;
    json["kinds"] = Json::array();
    for (const CoveredPart& kind : target.kinds) json["kinds"].push_back(part_json(kind));
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace skycap::missions::package
