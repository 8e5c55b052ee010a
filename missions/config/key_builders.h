/// How the tables of keys are written down: one call for each key, which binds it to its field.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "geometry/angle.h"
#include "missions/config/key.h"

namespace skycap::missions::config {

inline constexpr double far_away = 1e9;  // no survey is larger [m]

constexpr KeyRange above(double least, double most = far_away) { return {least, most, true}; }
constexpr KeyRange between(double least, double most) { return {least, most, false}; }

template <class T>
struct Unwrapped {
  using Type = T;
};
template <class T>
struct Unwrapped<std::optional<T>> {
  using Type = T;
};

/// The key that stands for the field of MissionDocument which `field` returns a reference to. A
/// field of type std::optional is left to be derived when the key is missing. `factor` turns the
/// file's numbers into the field's.
template <class Field>
Key key_for(std::string path, KeyType type, Field field, std::string meaning, double factor = 1.0) {
  using Stored = std::remove_reference_t<decltype(field(std::declval<MissionDocument&>()))>;
  using Value = typename Unwrapped<Stored>::Type;

  Key key;
  key.path = std::move(path);
  key.type = type;
  key.meaning = std::move(meaning);
  key.set = [=](MissionDocument& mission, const KeyValue& value) {
    if constexpr (std::is_same_v<Value, double>) {
      field(mission) = factor * std::get<double>(value);
    } else if constexpr (std::is_same_v<Value, Eigen::Vector3d>) {
      field(mission) = Value(factor * std::get<Eigen::Vector3d>(value));
    } else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) {
      field(mission) = static_cast<Value>(std::get<std::int64_t>(value));
    } else {
      field(mission) = std::get<Value>(value);
    }
  };
  key.get = [=](const MissionDocument& mission) -> std::optional<KeyValue> {
    const Stored stored = field(mission);
    Value value;
    if constexpr (std::is_same_v<Stored, Value>) {
      value = stored;
    } else {
      if (!stored) return std::nullopt;
      value = *stored;
    }
    if constexpr (std::is_same_v<Value, double>) {
      return value / factor;
    } else if constexpr (std::is_same_v<Value, Eigen::Vector3d>) {
      return Eigen::Vector3d(value / factor);
    } else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) {
      return static_cast<std::int64_t>(value);
    } else {
      return value;
    }
  };
  return key;
}

template <class Field>
Key text_key(std::string path, Field field, std::string meaning) {
  return key_for(std::move(path), KeyType::text, field, std::move(meaning));
}

/// A key whose values have a unit and a range. The field holds them times `factor`.
template <class Field>
Key quantity_key(KeyType type, std::string path, std::string unit, KeyRange range, Field field,
                 std::string meaning, double factor = 1.0) {
  Key key = key_for(std::move(path), type, field, std::move(meaning), factor);
  key.unit = std::move(unit);
  key.range = range;
  return key;
}

template <class Field>
Key number_key(std::string path, std::string unit, KeyRange range, Field field,
               std::string meaning) {
  return quantity_key(KeyType::number, std::move(path), std::move(unit), range, field,
                      std::move(meaning));
}

/// A number of degrees whose field is in radians.
template <class Field>
Key angle_key(std::string path, KeyRange range, Field field, std::string meaning) {
  return quantity_key(KeyType::number, std::move(path), "degrees", range, field, std::move(meaning),
                      geometry::radians_per_degree);
}

template <class Field>
Key integer_key(std::string path, std::string unit, KeyRange range, Field field,
                std::string meaning) {
  return quantity_key(KeyType::integer, std::move(path), std::move(unit), range, field,
                      std::move(meaning));
}

template <class Field>
Key boolean_key(std::string path, Field field, std::string meaning) {
  return key_for(std::move(path), KeyType::boolean, field, std::move(meaning));
}

template <class Field>
Key vector_key(std::string path, std::string unit, KeyRange range, Field field,
               std::string meaning) {
  return quantity_key(KeyType::vector, std::move(path), std::move(unit), range, field,
                      std::move(meaning));
}

/// Three numbers of degrees whose field is in radians.
template <class Field>
Key angles_key(std::string path, KeyRange range, Field field, std::string meaning) {
  return quantity_key(KeyType::vector, std::move(path), "degrees", range, field, std::move(meaning),
                      geometry::radians_per_degree);
}

/// A key for an enumeration whose values, from 0 on, are called `choices`.
template <class Field>
Key choice_key(std::string path, std::vector<std::string> choices, Field field,
               std::string meaning) {
  using Value = std::remove_reference_t<decltype(field(std::declval<MissionDocument&>()))>;
  Key key;
  key.path = std::move(path);
  key.type = KeyType::choice;
  key.choices = std::move(choices);
  key.meaning = std::move(meaning);
  key.set = [field, names = key.choices](MissionDocument& mission, const KeyValue& value) {
    const auto name = std::ranges::find(names, std::get<std::string>(value));
    field(mission) = static_cast<Value>(name - names.begin());
  };
  key.get = [field,
             names = key.choices](const MissionDocument& mission) -> std::optional<KeyValue> {
    return names[static_cast<std::size_t>(field(mission))];
  };
  return key;
}

/// Says in words what happens without the key.
inline Key otherwise(std::string fallback, Key key) {
  key.fallback = std::move(fallback);
  return key;
}

inline Key required(Key key) {
  key.is_required = true;
  return key;
}

/// A key for one corner of an optional box, which the first of the two keys brings about.
template <class Field>
Key box_corner(std::string path, Field field, bool is_upper, std::string meaning) {
  Key key;
  key.path = std::move(path);
  key.type = KeyType::vector;
  key.unit = std::string(1, 'm');  // of a literal, GCC 12 warns without cause
  key.range = between(-far_away, far_away);
  key.meaning = std::move(meaning);
  key.set = [field, is_upper](MissionDocument& mission, const KeyValue& value) {
    std::optional<Eigen::AlignedBox3d>& box = field(mission);
    if (!box) {
      box = Eigen::AlignedBox3d(Eigen::Vector3d::Constant(-far_away),
                                Eigen::Vector3d::Constant(far_away));
    }
    (is_upper ? box->max() : box->min()) = std::get<Eigen::Vector3d>(value);
  };
  key.get = [field, is_upper](const MissionDocument& mission) -> std::optional<KeyValue> {
    const std::optional<Eigen::AlignedBox3d>& box = field(mission);
    if (!box) return std::nullopt;
    return is_upper ? box->max() : box->min();
  };
  return key;
}

/// One list of several.
inline std::vector<Key> joined(std::initializer_list<std::vector<Key>> lists) {
  std::vector<Key> all;
  for (const std::vector<Key>& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

}  // namespace skycap::missions::config
