// The keys that belong to no section, and those of `scene`.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"
#include "sim/models/models.h"

namespace skycap::missions::config {
namespace {

Key copies_key() {
  Key key = key_for(
      "scene.copies", KeyType::vectors, [](auto& m) -> auto& { return m.scene.copies; },
      "The same model at more places, each [east, north, turn_deg]: metres from position, and "
      "a turn anticlockwise about its own upright.");
  key.range = between(-1e6, 1e6);
  const auto turned = [](const KeyValue& value, double factor) {
    auto copies = std::get<std::vector<Eigen::Vector3d>>(value);
    for (Eigen::Vector3d& copy : copies) copy.z() *= factor;
    return copies;
  };
  key.set = [set = key.set, turned](MissionDocument& mission, const KeyValue& value) {
    set(mission, turned(value, geometry::radians_per_degree));
  };
  key.get = [get = key.get, turned](const MissionDocument& mission) -> std::optional<KeyValue> {
    return turned(*get(mission), 1.0 / geometry::radians_per_degree);
  };
  return key;
}

Key detail_key() {
  Key key = choice_key(
      "scene.detail", {"coarse", "standard", "fine"},
      [](auto& m) -> auto& { return m.scene.detail; },
      "Level of detail of a builtin model: the same shape in more and smaller triangles.");
  key.get = [get = key.get](const MissionDocument& mission) -> std::optional<KeyValue> {
    if (!mission.scene.model.starts_with("builtin:")) return std::nullopt;
    return get(mission);
  };
  return otherwise("standard", key);
}

Key drawn_key() {
  Key key = integer_key(
      "scene.seed", "", between(0, 1e15), [](auto& m) -> auto& { return m.scene.seed; },
      "Of a builtin model that is drawn, such as the city block: which of them.");
  key.get = [get = key.get](const MissionDocument& mission) -> std::optional<KeyValue> {
    constexpr std::string_view builtin = "builtin:";
    const std::string_view model = mission.scene.model;
    if (!model.starts_with(builtin) || !sim::is_drawn(model.substr(builtin.size()))) {
      return std::nullopt;
    }
    return get(mission);
  };
  return otherwise("1", key);
}

Key model_key() {
  Key key = text_key(
      "scene.model", [](auto& m) -> auto& { return m.scene.model; },
      "What is surveyed: builtin:NAME, model:NAME, or the path of a PLY, OBJ, STL or OFF file, "
      "relative to the mission file, or NAME.tiles of many (docs/reference/batch-files.md); prior: "
      "the targets "
      "among the prior data stand in for it. A "
      "mission without it is for live surveys (docs/howto/use-your-own-sensor.md).");
  key.fallback = "none";
  key.get = [](const MissionDocument& mission) -> std::optional<KeyValue> {
    if (mission.scene.model.empty()) return std::nullopt;
    return mission.scene.model;
  };
  return key;
}

}  // namespace

std::vector<Key> general_keys() {
  return {
      otherwise("the file's name", text_key(
                                       "name", [](auto& m) -> auto& { return m.name; },
                                       "Names the folder of the results.")),
      integer_key(
          "seed", "", between(0, 1e15), [](auto& m) -> auto& { return m.seed; },
          "Of the start view and the sensor's noise; the same seed gives the same results."),
      integer_key(
          "threads", "", between(0, 1024), [](auto& m) -> auto& { return m.threads; },
          "How many threads to use, 0 for all processors; does not change the results."),
  };
}

std::vector<Key> scene_keys() {
  return {
      model_key(),
      detail_key(),
      drawn_key(),
      choice_key(
          "scene.up_axis", {"z", "y"}, [](auto& m) -> auto& { return m.scene.up_axis; },
          "Which axis of the model's own frame points up."),
      angles_key(
          "scene.rotation_deg", between(-360, 360),
          [](auto& m) -> auto& { return m.scene.rotation; },
          "Turns the upright model about the x, then the y, then the z axis."),
      otherwise("the model's own size",
                number_key(
                    "scene.longest_side", "m", above(0, 1e6),
                    [](auto& m) -> auto& { return m.scene.longest_side; },
                    "Scales the model until the longest side of its bounding box has this "
                    "length.")),
      otherwise("1", number_key(
                         "scene.scale", "", above(0, far_away),
                         [](auto& m) -> auto& { return m.scene.scale; },
                         "Scales the model by a factor, in place of longest_side.")),
      vector_key(
          "scene.position", "m", between(-1e6, 1e6),
          [](auto& m) -> auto& { return m.scene.position; },
          "Where the middle of the base of the model's bounding box is put."),
      copies_key(),
      boolean_key(
          "scene.ground", [](auto& m) -> auto& { return m.scene.ground; },
          "Whether the sensor also sees a ground plane under the model. It is not part of the "
          "coverage; planner.scene_box has to keep it out of the plan."),
      boolean_key(
          "scene.neighbours", [](auto& m) -> auto& { return m.scene.neighbours; },
          "Whether the sensor also sees the buildings that prior data of the role obstacle hold "
          "beside what is surveyed. They are not part of the coverage."),
      number_key(
          "scene.reflectance", "", between(0, 1),
          [](auto& m) -> auto& { return m.scene.reflectance; },
          "Diffuse reflectance of surfaces at the laser's wavelength, for skycap scan."),
      otherwise("-", text_key(
                         "scene.materials", [](auto& m) -> auto& { return m.scene.materials; },
                         "YAML file of a line NAME: VALUE for each material of the model (usemtl "
                         "of an OBJ), relative to the mission file. VALUE is a reflectance, or "
                         "glass, which returns nothing, or mirror.")),
  };
}

}  // namespace skycap::missions::config
