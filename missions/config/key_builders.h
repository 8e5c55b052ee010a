/// Builders for the key tables. Each call describes one key and binds it to its document field.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "missions/config/key.h"

namespace skycap::missions::config {

inline constexpr double far_away = 1e9;  // upper bound for lengths in a survey [m]

constexpr KeyRange above(double min, double max = far_away) { return {min, max, true}; }
constexpr KeyRange between(double min, double max) { return {min, max, false}; }

/// Type-erased read and write access to a field. Field values are `factor` times the file's values.
struct FieldAccess {
  void (*write)(void* field, double factor, const KeyValue& value);
  /// Returns nullopt if the field is an empty optional, whose value is derived later.
  std::optional<KeyValue> (*read)(const void* field, double factor);
};

namespace detail {

template <class T>
struct Unwrapped {
  using Type = T;
};
template <class T>
struct Unwrapped<std::optional<T>> {
  using Type = T;
};

template <class Stored>
void write_field(void* field, double factor, const KeyValue& value) {
  using Value = typename Unwrapped<Stored>::Type;
  auto& stored = *static_cast<Stored*>(field);
  if constexpr (std::is_same_v<Value, double>) {
    stored = factor * std::get<double>(value);
  } else if constexpr (std::is_same_v<Value, Eigen::Vector3d>) {
    stored = Value(factor * std::get<Eigen::Vector3d>(value));
  } else if constexpr ((std::is_integral_v<Value> && !std::is_same_v<Value, bool>) ||
                       std::is_enum_v<Value>) {
    stored = static_cast<Value>(std::get<std::int64_t>(value));
  } else {
    stored = std::get<Value>(value);
  }
}

template <class Stored>
std::optional<KeyValue> read_field(const void* field, double factor) {
  using Value = typename Unwrapped<Stored>::Type;
  const Stored& stored = *static_cast<const Stored*>(field);
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
  } else if constexpr ((std::is_integral_v<Value> && !std::is_same_v<Value, bool>) ||
                       std::is_enum_v<Value>) {
    return static_cast<std::int64_t>(value);
  } else {
    return value;
  }
}

template <class Stored>
inline constexpr FieldAccess access_to{write_field<Stored>, read_field<Stored>};

}  // namespace detail

/// Binding of a key to a MissionDocument field, with read and write access. Constructed from a
/// function that returns a reference to the field. Empty std::optional fields are derived later.
/// Enumerations are accessed as integers.
struct BoundField {
  template <class Field, class Reference = std::invoke_result_t<Field, MissionDocument&>>
  BoundField(Field field)  // implicit, so that key tables list only the accessor
      : location([field](MissionDocument& mission) -> void* { return &field(mission); }),
        find([field](const MissionDocument& mission) -> const void* { return &field(mission); }),
        access(&detail::access_to<std::remove_reference_t<Reference>>) {
    static_assert(std::is_lvalue_reference_v<Reference>);
  }

  std::function<void*(MissionDocument&)> location;
  std::function<const void*(const MissionDocument&)> find;
  const FieldAccess* access;
};

/// Creates a key for a field. Values in the file are multiplied by `factor` when stored.
Key key_for(std::string path, KeyType type, BoundField field, std::string meaning,
            double factor = 1.0);

/// Creates a key with a list or map value. An empty list or map counts as missing.
Key list_key(std::string path, KeyType type, BoundField field, std::string meaning);

Key text_key(std::string path, BoundField field, std::string meaning);

/// Creates a key with a unit and a range. Values are multiplied by `factor` when stored.
Key quantity_key(KeyType type, std::string path, std::string unit, KeyRange range, BoundField field,
                 std::string meaning, double factor = 1.0);

Key number_key(std::string path, std::string unit, KeyRange range, BoundField field,
               std::string meaning);

/// Creates a key in degrees whose field is in radians.
Key angle_key(std::string path, KeyRange range, BoundField field, std::string meaning);

Key integer_key(std::string path, std::string unit, KeyRange range, BoundField field,
                std::string meaning);

Key boolean_key(std::string path, BoundField field, std::string meaning);

Key vector_key(std::string path, std::string unit, KeyRange range, BoundField field,
               std::string meaning);

/// Creates a key of three angles in degrees whose field is in radians.
Key angles_key(std::string path, KeyRange range, BoundField field, std::string meaning);

/// Creates a key for an enumeration. `choices` names its values, starting with value 0.
Key choice_key(std::string path, std::vector<std::string> choices, BoundField field,
               std::string meaning);

/// Sets the description of the default, for keys without a fixed default value.
Key otherwise(std::string fallback, Key key);

Key required(Key key);

/// Creates a key for one corner of an optional box. Setting either corner creates the box; the
/// other corner is then unbounded (±far_away).
template <class Field>
Key box_corner(std::string path, Field field, bool is_upper, std::string meaning) {
  Key key;
  key.path = std::move(path);
  key.type = KeyType::vector;
  key.unit = std::string(1, 'm');  // avoids a false warning of GCC 12 for string literals
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

/// Concatenates lists of keys.
std::vector<Key> joined(std::initializer_list<std::vector<Key>> lists);

}  // namespace skycap::missions::config
