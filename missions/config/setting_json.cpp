#include "missions/config/setting_json.h"

#include <algorithm>
#include <string>
#include <type_traits>

#include "missions/config/mission_keys.h"
#include "missions/support/json_text.h"

namespace skycap::missions::config {
namespace {

using Json = nlohmann::ordered_json;

Json list_json(const std::vector<Eigen::Vector2d>& polygon) {
  Json corners = Json::array();
  for (const Eigen::Vector2d& corner : polygon) corners.push_back({corner.x(), corner.y()});
  return corners;
}

Json list_json(const std::vector<geometry::Prism>& volumes) {
  Json list = Json::array();
  for (const geometry::Prism& volume : volumes) {
    list.push_back({{"corners", list_json(volume.footprint)},
                    {"floor", volume.floor},
                    {"ceiling", volume.ceiling}});
  }
  return list;
}

/// Returns a map of the required keys and of all keys that differ from their default.
Json map_json(const site_data::Source& source) {
  MissionDocument mission, blank;
  mission.prior.push_back(source);
  blank.prior.emplace_back();
  Json map = Json::object();
  for (const Key& key : find_key("prior")->items) {
    const auto value = key.get(mission), usual = key.get(blank);
    if (!value) continue;
    const Json json = setting_json(*value);
    if (!key.is_required && usual && json == setting_json(*usual)) continue;
    std::string pointer = "/" + key.path;
    std::ranges::replace(pointer, '.', '/');
    map[Json::json_pointer(pointer)] = json;
  }
  return map;
}

Json list_json(const std::vector<site_data::Source>& sources) {
  Json list = Json::array();
  for (const site_data::Source& source : sources) list.push_back(map_json(source));
  return list;
}

}  // namespace

Json setting_json(const KeyValue& value) {
  return std::visit(
      [](const auto& plain) -> Json {
        using Value = std::decay_t<decltype(plain)>;
        if constexpr (std::is_same_v<Value, Eigen::Vector3d> ||
                      std::is_same_v<Value, std::vector<Eigen::Vector3d>>) {
          return support::to_json(plain);
        } else if constexpr (requires { list_json(plain); }) {
          return list_json(plain);
        } else {
          return plain;
        }
      },
      value);
}

}  // namespace skycap::missions::config
