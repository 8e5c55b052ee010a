/// One key of the mission file: its name, what it takes, what it means, and which field of
/// MissionDocument it stands for.
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
  polygon,  ///< corners [x, y], three or more
  volumes,  ///< a list of {corners, floor, ceiling}
  vectors,  ///< a list of lists of three numbers
  texts,    ///< a list of texts
  integers,
  pairs,    ///< a map from texts to texts
  sources,  ///< a list of maps, each with the keys Key::items
};

/// Which numbers a key takes; for a vector, each of its three.
struct KeyRange {
  double least = -std::numeric_limits<double>::max();
  double most = std::numeric_limits<double>::max();
  bool excludes_least = false;
};

/// A value as the file says it, in the file's unit. Text and choices are both text.
using KeyValue =
    std::variant<bool, std::int64_t, double, std::string, Eigen::Vector3d,
                 std::vector<Eigen::Vector2d>, std::vector<geometry::Prism>,
                 std::vector<Eigen::Vector3d>, std::vector<std::string>, std::vector<int>,
                 std::map<std::string, std::string>, std::vector<site_data::Source>>;

struct Key {
  std::string path;  ///< such as "planner.density"
  KeyType type = KeyType::text;
  std::string unit;  ///< as printed; empty for pure numbers
  KeyRange range;
  std::vector<std::string> choices;  ///< of a number: words that it takes as well
  bool is_required = false;
  std::string fallback;  ///< in words, when the default is not a value
  std::string meaning;   ///< one sentence for the user
  /// The keys of each map of a list. They set and get the last of the mission's list.
  std::vector<Key> items;

  /// Puts a value of the right type and range into a mission.
  std::function<void(MissionDocument&, const KeyValue&)> set;
  /// The value in a mission; nothing if it is left to be derived.
  std::function<std::optional<KeyValue>(const MissionDocument&)> get;
};

}  // namespace skycap::missions::config
