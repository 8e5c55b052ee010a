/// JSON as files and messages hold it.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace skycap::missions::support {

/// A JSON file's text. Names that are not valid UTF-8 are shown with a replacement character.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

inline nlohmann::ordered_json json_of(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

inline nlohmann::ordered_json json_of(const std::vector<Eigen::Vector3d>& vectors) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Eigen::Vector3d& vector : vectors) list.push_back(json_of(vector));
  return list;
}

/// Throws what nlohmann::json throws for anything but three numbers or more.
inline Eigen::Vector3d vector_of(const nlohmann::ordered_json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

}  // namespace skycap::missions::support
