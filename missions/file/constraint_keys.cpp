// Keys for where the sensor may be, when a survey ends, and which of Skycap's ideas are on.
#include "missions/file/key_builders.h"

namespace skycap::missions::file {
namespace {

constexpr double right_angle = 90.0;  // [degrees]

/// A key whose value is a list; an empty one stands for none.
template <class Field>
Key list(std::string path, KeyType type, Field field, std::string meaning) {
  using List = std::remove_reference_t<decltype(field(std::declval<Mission&>()))>;
  Key key;
  key.path = std::move(path);
  key.type = type;
  key.unit = "m";
  key.fallback = "none";
  key.meaning = std::move(meaning);
  key.set = [field](Mission& mission, const KeyValue& value) {
    field(mission) = std::get<List>(value);
  };
  key.get = [field](const Mission& mission) -> std::optional<KeyValue> {
    const List& stored = field(const_cast<Mission&>(mission));
    return stored.empty() ? std::nullopt : std::optional<KeyValue>(stored);
  };
  return key;
}

Key idea(const std::string& name, bool survey::skycap::SkycapIdeas::*member,
         const std::string& meaning) {
  return boolean(
      "planner.ideas." + name,
      [member](Mission & m) -> auto& { return m.planner.skycap_ideas.*member; },
      "skycap: " + meaning);
}

}  // namespace

std::vector<Key> constraint_keys() {
  using Ideas = survey::skycap::SkycapIdeas;
  return {
      list(
          "site.geofence", KeyType::polygon, [](Mission & m) -> auto& { return m.site.geofence; },
          "Polygon, east and north in the mission's frame, that views stay inside of."),
      list(
          "site.no_fly", KeyType::volumes, [](Mission & m) -> auto& { return m.site.no_fly; },
          "Upright prisms that views stay outside of; bottom and top are z in the mission's "
          "frame."),
      otherwise("unlimited", number(
                                 "site.lowest_height", "m", between(-1e6, 1e6),
                                 [](Mission & m) -> auto& { return m.site.lowest_height; },
                                 "Least z of a view in the mission's frame.")),
      otherwise("unlimited", number(
                                 "site.highest_height", "m", between(-1e6, 1e6),
                                 [](Mission & m) -> auto& { return m.site.highest_height; },
                                 "Greatest z of a view in the mission's frame.")),
      number(
          "limits.stand_off", "m", between(0, 1e4),
          [](Mission & m) -> auto& { return m.limits.stand_off; },
          "Least distance of a view from everything measured; with skycap, inside the scene's box, "
          "also from space that was not seen to be empty."),
      number(
          "limits.lowest_pitch_deg", "degrees", between(-right_angle, right_angle),
          [](Mission & m) -> auto& { return m.limits.lowest_pitch; },
          "How far down the gimbal turns the sensor; straight down is -90."),
      number(
          "limits.highest_pitch_deg", "degrees", between(-right_angle, right_angle),
          [](Mission & m) -> auto& { return m.limits.highest_pitch; },
          "How far up the gimbal turns the sensor."),
      otherwise("unlimited",
                number(
                    "limits.max_minutes", "min", above(0),
                    [](Mission & m) -> auto& { return m.limits.max_minutes; },
                    "The survey ends when it would take longer than this, by the two keys below.")),
      number(
          "limits.speed", "m/s", above(0, 1e3), [](Mission & m) -> auto& { return m.limits.speed; },
          "How fast the sensor flies from view to view, for limits.max_minutes."),
      number(
          "limits.time_per_view", "s", between(0, 1e6),
          [](Mission & m) -> auto& { return m.limits.time_per_view; },
          "How long a view takes: to stop, turn and measure; for limits.max_minutes."),
      idea("dose", &Ideas::dose, "weigh looks at a surface by the noise; off: one look covers it."),
      idea("unseen_surface", &Ideas::unseen_surface, "guess where the surface goes on."),
      idea("free_space", &Ideas::free_space, "drop guesses where the sensor saw through."),
      idea("learned_rates", &Ideas::learned_rates,
           "grade the guesses by what became of earlier ones."),
      idea("targeted_views", &Ideas::targeted_views,
           "propose views for what is missing; off: from fixed directions only."),
      idea("refinement", &Ideas::refinement, "move the best views about their target."),
      idea("batch", &Ideas::batch, "plan several views ahead; off: the best next one only."),
  };
}

}  // namespace skycap::missions::file
