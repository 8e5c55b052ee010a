#include "missions/config/photo_camera_reader.h"

#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/config/preset_files.h"
#include "missions/support/yaml_section.h"

namespace skycap::missions::config {
namespace {

/// Returns the two numbers of a list.
Eigen::Vector2d pair_of(support::YamlSection& section, const std::string& key) {
  const std::vector<double> values = section.numbers(key);
  if (values.size() != 2) section.fail_at(key, "must be a list of two numbers: width and height");
  return {values[0], values[1]};
}

int pixels(support::YamlSection& section, double value) {
  if (!(value >= 1.0 && value <= 1e6) || value != static_cast<int>(value)) {
    section.fail_at("image_size_px", "must be two integers of at least 1 px");
  }
  return static_cast<int>(value);
}

}  // namespace

geometry::PhotoCameraConfig read_photo_camera(const std::string& text, const std::string& file) {
  const support::YamlNode tree = support::parse_yaml(text, file);
  support::YamlSection root(tree, "", file);
  geometry::PhotoCameraConfig camera;
  camera.name = root.text("name");
  if (root.text("kind") != "photo_camera") root.fail_at("kind", "must be photo_camera");
  constexpr double mm = 1e-3;
  camera.focal_length = mm * root.number("focal_length_mm");
  camera.sensor_size = mm * pair_of(root, "sensor_size_mm");
  const Eigen::Vector2d size = pair_of(root, "image_size_px");
  camera.width = pixels(root, size.x());
  camera.height = pixels(root, size.y());
  if (root.has("horizontal_fov_deg")) {
    camera.horizontal_fov = geometry::radians_per_degree * root.number("horizontal_fov_deg");
  }
  camera.min_interval = root.number("min_interval");
  camera.shutter = root.choice<geometry::ShutterKind>(
      "shutter", {{"mechanical", geometry::ShutterKind::mechanical},
                  {"electronic", geometry::ShutterKind::electronic}});
  camera.readout = root.number("readout", camera.readout);
  camera.exposure = root.number("exposure", camera.exposure);
  camera.nearest_focus = root.number("nearest_focus", camera.nearest_focus);
  camera.formats = root.texts("formats");
  if (auto section = root.section("distortion")) {
    geometry::BrownDistortion distortion;
    distortion.k1 = section->number("k1", 0.0);
    distortion.k2 = section->number("k2", 0.0);
    distortion.p1 = section->number("p1", 0.0);
    distortion.p2 = section->number("p2", 0.0);
    distortion.k3 = section->number("k3", 0.0);
    section->finish();
    camera.distortion = distortion;
  }
  root.finish();
  try {
    camera.validate();
  } catch (const Error& error) {  // The error contains the field, but not the file.
    throw Error(error.kind(), file + ": " + error.what());
  }
  return camera;
}

std::vector<std::string_view> photo_camera_presets() {
  std::vector<std::string_view> names;
  for (const PresetFile& preset : photo_camera_preset_files()) names.push_back(preset.name);
  return names;
}

geometry::PhotoCameraConfig find_photo_camera(const std::string& name_or_file) {
  const PresetText found = preset_text("photo camera", name_or_file, photo_camera_preset_files());
  return read_photo_camera(found.text, found.file);
}

}  // namespace skycap::missions::config
