// Top-level keys and keys of the section `scene`.
#include "geometry/angle.h"
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"
#include "sim/models/models.h"

namespace skycap::missions::config {
namespace {

Key copies_key() {
  Key key = key_for(
      "scene.copies", KeyType::vectors, [](auto& m) -> auto& { return m.scene.copies; },
      "Copies of the model, each [east, north, turn_deg]: offset from position in metres and "
      "counter-clockwise rotation about the vertical axis.");
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
      "Level of detail of a builtin model. Finer levels have the same shape with more, smaller "
      "triangles.");
  key.get = [get = key.get](const MissionDocument& mission) -> std::optional<KeyValue> {
    if (!mission.scene.model.starts_with("builtin:")) return std::nullopt;
    return get(mission);
  };
  return otherwise("standard", key);
}

Key drawn_key() {
  Key key = integer_key(
      "scene.seed", "", between(0, 1e15), [](auto& m) -> auto& { return m.scene.seed; },
      "Random seed of a generated builtin model, such as the city block.");
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
      "Scene to survey: builtin:NAME, model:NAME, a PLY, OBJ, STL or OFF file, or a tile list "
      "NAME.tiles (docs/reference/batch-files.md). File paths are relative to the mission file. "
      "prior: the targets in the prior data, used as ground truth. A mission without a scene is a "
      "live survey (docs/howto/use-your-own-sensor.md).");
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
                                       "Name of the mission and of its results folder.")),
      integer_key(
          "seed", "", between(0, 1e15), [](auto& m) -> auto& { return m.seed; },
          "Random seed of the start view and the sensor noise. The same seed produces the same "
          "results."),
      integer_key(
          "threads", "", between(0, 1024), [](auto& m) -> auto& { return m.threads; },
          "Number of threads; 0: all processors. Does not change the results."),
  };
}

std::vector<Key> scene_keys() {
  return {
      model_key(),
      detail_key(),
      drawn_key(),
      choice_key(
          "scene.up_axis", {"z", "y"}, [](auto& m) -> auto& { return m.scene.up_axis; },
          "Axis of the model's own frame that points up."),
      angles_key(
          "scene.rotation_deg", between(-360, 360),
          [](auto& m) -> auto& { return m.scene.rotation; },
          "Rotation of the upright model about the x, then the y, then the z axis."),
      otherwise("the model's own size", number_key(
                                            "scene.longest_side", "m", above(0, 1e6),
                                            [](auto& m) -> auto& { return m.scene.longest_side; },
                                            "Length of the longest side of the model's bounding "
                                            "box; the model is scaled to it.")),
      otherwise("1", number_key(
                         "scene.scale", "", above(0, far_away),
                         [](auto& m) -> auto& { return m.scene.scale; },
                         "Scale factor of the model, instead of longest_side.")),
      vector_key(
          "scene.position", "m", between(-1e6, 1e6),
          [](auto& m) -> auto& { return m.scene.position; },
          "Position of the base centre of the model's bounding box."),
      copies_key(),
      boolean_key(
          "scene.ground", [](auto& m) -> auto& { return m.scene.ground; },
          "Add a ground plane under the model, visible to the sensor. It is not part of the "
          "coverage; planner.scene_box must exclude it."),
      boolean_key(
          "scene.neighbours", [](auto& m) -> auto& { return m.scene.neighbours; },
          "Add the buildings of prior data with role obstacle, visible to the sensor. They are not "
          "part of the coverage."),
      number_key(
          "scene.reflectance", "", between(0, 1),
          [](auto& m) -> auto& { return m.scene.reflectance; },
          "Diffuse reflectance of surfaces at the laser's wavelength, for skycap scan."),
      otherwise("-", text_key(
                         "scene.materials", [](auto& m) -> auto& { return m.scene.materials; },
                         "YAML file with a line NAME: VALUE for each material of the model (usemtl "
                         "of an OBJ), relative to the mission file. VALUE is a reflectance, glass "
                         "(no return) or mirror.")),
  };
}

}  // namespace skycap::missions::config
