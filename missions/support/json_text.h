/// JSON helpers for files and messages.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace skycap::missions::support {

/// Returns the contents of a JSON file. Invalid UTF-8 is replaced by the replacement character.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

inline nlohmann::ordered_json to_json(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

inline nlohmann::ordered_json to_json(const std::vector<Eigen::Vector3d>& vectors) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Eigen::Vector3d& vector : vectors) list.push_back(to_json(vector));
  return list;
}

/// Throws the errors of nlohmann::json unless the value is an array of at least three numbers.
inline Eigen::Vector3d to_vector(const nlohmann::ordered_json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

}  // namespace skycap::missions::support
