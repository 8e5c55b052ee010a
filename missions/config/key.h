/// Description of one mission key: its path, value type and range, documentation, and the
/// MissionDocument field it is bound to.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "missions/config/mission_document.h"

namespace skycap::missions::config {

enum class KeyType {
  text,
  number,
  integer,
  boolean,
  choice,
  vector,
  polygon,  ///< three or more corners [x, y]
  line,     ///< two or more points [x, y]
  volumes,  ///< list of {corners, floor, ceiling}
  vectors,  ///< list of [x, y, z]
  texts,    ///< list of strings
  integers,
  pairs,    ///< map from strings to strings
  sources,  ///< list of maps with the keys in Key::items
};

/// Permitted range of a number. For a vector, it applies to each component.
struct KeyRange {
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
  bool excludes_min = false;
};

/// Value in the unit of the mission file. Strings and choices are both stored as std::string.
using KeyValue =
    std::variant<bool, std::int64_t, double, std::string, Eigen::Vector3d,
                 std::vector<Eigen::Vector2d>, std::vector<geometry::Prism>,
                 std::vector<Eigen::Vector3d>, std::vector<std::string>, std::vector<int>,
                 std::map<std::string, std::string>, std::vector<site_data::Source>>;

struct Key {
  std::string path;  ///< full path, such as "planner.density"
  KeyType type = KeyType::text;
  std::string unit;  ///< printed unit; empty for dimensionless numbers
  KeyRange range;
  /// Permitted words; for a number, accepted in addition to numeric values.
  std::vector<std::string> choices;
  bool is_required = false;
  std::string fallback;  ///< description of the default where it is not a fixed value
  std::string meaning;   ///< user documentation, one sentence
  /// Keys of each map in a list. Their accessors operate on the last element of the mission's list.
  std::vector<Key> items;

  /// Stores a value in a mission. The value must have the key's type and be in range.
  std::function<void(MissionDocument&, const KeyValue&)> set;
  /// Returns the value in a mission, or nullopt if resolve() derives it.
  std::function<std::optional<KeyValue>(const MissionDocument&)> get;
};

}  // namespace skycap::missions::config
