#include "missions/config/key_builders.h"

#include <algorithm>
#include <utility>

#include "geometry/angle.h"

namespace skycap::missions::config {
namespace {

std::optional<KeyValue> read_value(const BoundField& field, const MissionDocument& mission,
                                   double factor) {
  return field.access->read(field.find(mission), factor);
}

}  // namespace

Key key_for(std::string path, KeyType type, BoundField field, std::string meaning, double factor) {
  Key key;
  key.path = std::move(path);
  key.type = type;
  key.meaning = std::move(meaning);
  key.set = [=](MissionDocument& mission, const KeyValue& value) {
    field.access->write(field.location(mission), factor, value);
  };
  key.get = [=](const MissionDocument& mission) { return read_value(field, mission, factor); };
  return key;
}

Key list_key(std::string path, KeyType type, BoundField field, std::string meaning) {
  Key key = key_for(std::move(path), type, std::move(field), std::move(meaning));
  key.get = [get = key.get](const MissionDocument& mission) -> std::optional<KeyValue> {
    auto value = get(mission);
    const bool is_empty = std::visit(
        [](const auto& list) {
          if constexpr (requires { list.empty(); }) return list.empty();
          return false;
        },
        *value);
    return is_empty ? std::nullopt : value;
  };
  return key;
}

Key text_key(std::string path, BoundField field, std::string meaning) {
  return key_for(std::move(path), KeyType::text, std::move(field), std::move(meaning));
}

Key quantity_key(KeyType type, std::string path, std::string unit, KeyRange range, BoundField field,
                 std::string meaning, double factor) {
  Key key = key_for(std::move(path), type, std::move(field), std::move(meaning), factor);
  key.unit = std::move(unit);
  key.range = range;
  return key;
}

Key number_key(std::string path, std::string unit, KeyRange range, BoundField field,
               std::string meaning) {
  return quantity_key(KeyType::number, std::move(path), std::move(unit), range, std::move(field),
                      std::move(meaning));
}

Key angle_key(std::string path, KeyRange range, BoundField field, std::string meaning) {
  return quantity_key(KeyType::number, std::move(path), "degrees", range, std::move(field),
                      std::move(meaning), geometry::radians_per_degree);
}

Key integer_key(std::string path, std::string unit, KeyRange range, BoundField field,
                std::string meaning) {
  return quantity_key(KeyType::integer, std::move(path), std::move(unit), range, std::move(field),
                      std::move(meaning));
}

Key boolean_key(std::string path, BoundField field, std::string meaning) {
  return key_for(std::move(path), KeyType::boolean, std::move(field), std::move(meaning));
}

Key vector_key(std::string path, std::string unit, KeyRange range, BoundField field,
               std::string meaning) {
  return quantity_key(KeyType::vector, std::move(path), std::move(unit), range, std::move(field),
                      std::move(meaning));
}

Key angles_key(std::string path, KeyRange range, BoundField field, std::string meaning) {
  return quantity_key(KeyType::vector, std::move(path), "degrees", range, std::move(field),
                      std::move(meaning), geometry::radians_per_degree);
}

Key choice_key(std::string path, std::vector<std::string> choices, BoundField field,
               std::string meaning) {
  Key key;
  key.path = std::move(path);
  key.type = KeyType::choice;
  key.choices = std::move(choices);
  key.meaning = std::move(meaning);
  key.set = [field, names = key.choices](MissionDocument& mission, const KeyValue& value) {
    const auto name = std::ranges::find(names, std::get<std::string>(value));
    field.access->write(field.location(mission), 1.0, std::int64_t{name - names.begin()});
  };
  key.get = [field,
             names = key.choices](const MissionDocument& mission) -> std::optional<KeyValue> {
    const auto number = read_value(field, mission, 1.0);
    if (!number) return std::nullopt;
    return names[static_cast<std::size_t>(std::get<std::int64_t>(*number))];
  };
  return key;
}

Key otherwise(std::string fallback, Key key) {
  key.fallback = std::move(fallback);
  return key;
}

Key required(Key key) {
  key.is_required = true;
  return key;
}

std::vector<Key> joined(std::initializer_list<std::vector<Key>> lists) {
  std::vector<Key> all;
  for (const std::vector<Key>& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

}  // namespace skycap::missions::config
