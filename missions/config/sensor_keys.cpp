// The keys of `sensor`.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {
namespace {

auto image(auto member) {
  return [member](auto& m) -> auto& { return m.sensor.options.camera.camera.*member; };
}
auto noise(auto member) {
  return [member](auto& m) -> auto& { return m.sensor.options.camera.noise.*member; };
}

/// The key `sensor.frame_period`, which means nothing without frames on the way.
Key frame_period_key() {
  Key key = number_key(
      "sensor.frame_period", "s", between(0.05, 3600),
      [](auto& m) -> auto& { return m.sensor.options.frame_period; },
      "Time between the frames that are taken on the way, with sensor.capture moving. The camera "
      "turns from each to the next, and stands while it is exposed.");
  key.fallback = "1 s";
  key.get = [get = key.get](const MissionDocument& mission) -> std::optional<KeyValue> {
    return mission.sensor.options.is_moving() ? get(mission) : std::nullopt;
  };
  return key;
}

/// The key `sensor.lidar`, whose scanner takes the camera's place.
Key lidar_key() {
  return otherwise("-",
                   text_key(
                       "sensor.lidar", [](auto& m) -> auto& { return m.sensor.lidar; },
                       "In place of a depth camera, a laser scanner: a preset of "
                       "sim/sensors/presets, or the path of a description (NAME.yaml), relative "
                       "to the mission file. With a vehicle it measures all the way, fixed to the "
                       "airframe as scan.mount says; without one it stops at each view and turns "
                       "once, or looks for half a second; a scanner of a single line needs one. "
                       "Of the section sensor only capture and frame_period go with it."));
}

}  // namespace

std::vector<Key> sensor_keys() {
  return {
      choice_key(
          "sensor.preset", {"d435", "high_resolution"},
          [](auto& m) -> auto& { return m.sensor.preset; },
          "Depth camera whose values the keys below override: d435 is an Intel RealSense D435 "
          "(848 x 480 pixels, 69.4 x 42.5 degrees), high_resolution the paper's for buildings "
          "(2400 x 1750 pixels, 60 x 40 degrees)."),
      lidar_key(),
      integer_key("sensor.width", "px", between(1, 32768), image(&geometry::CameraConfig::width),
                  "Columns of the image."),
      integer_key("sensor.height", "px", between(1, 32768), image(&geometry::CameraConfig::height),
                  "Rows of the image."),
      angle_key("sensor.horizontal_fov_deg", between(0.1, 179),
                image(&geometry::CameraConfig::horizontal_fov), "Full horizontal angle of view."),
      angle_key("sensor.vertical_fov_deg", between(0.1, 179),
                image(&geometry::CameraConfig::vertical_fov), "Full vertical angle of view."),
      number_key("sensor.min_range", "m", between(0, 1e6),
                 image(&geometry::CameraConfig::min_range),
                 "Nearest depth, along the optical axis, that is measured."),
      number_key("sensor.max_range", "m", above(0, 1e6), image(&geometry::CameraConfig::max_range),
                 "Farthest depth, along the optical axis, that is measured."),
      angle_key(
          "sensor.max_incidence_deg", above(0, 90),
          [](auto& m) -> auto& { return m.sensor.options.camera.max_incidence; },
          "Surfaces whose normal makes a larger angle than this with the ray give no return; 90 "
          "switches the limit off."),
      number_key(
          "sensor.exposure", "s", between(0, 10),
          [](auto& m) -> auto& { return m.sensor.options.shutter.exposure; },
          "How long a picture is exposed. A flown view lasts at least as long as exposure "
          "and readout, and the summary bounds the blur."),
      number_key(
          "sensor.readout", "s", between(0, 10),
          [](auto& m) -> auto& { return m.sensor.options.shutter.readout; },
          "Of a rolling shutter, the time between the exposures of the first row and of the "
          "last; 0 is a global one."),
      number_key(
          "sensor.settle", "s", between(0, 3600),
          [](auto& m) -> auto& { return m.sensor.options.settle; },
          "Least time at rest before the capture; flight.hold may ask for more."),
      choice_key(
          "sensor.capture", {"stops", "moving"},
          [](auto& m) -> auto& { return m.sensor.options.capture; },
          "Whether a flown survey measures at its views only, or on the ways between them too; "
          "moving needs a vehicle and the planner skycap."),
      frame_period_key(),
      number_key("sensor.noise.sigma", "m", between(0, 1e3), noise(&sim::NoiseConfig::sigma),
                 "Standard deviation of the Gaussian noise of the measured points."),
      choice_key("sensor.noise.direction", {"isotropic", "along_ray"},
                 noise(&sim::NoiseConfig::direction),
                 "Whether the noise moves a point in x, y and z alike or along its ray only."),
  };
}

}  // namespace skycap::missions::config
