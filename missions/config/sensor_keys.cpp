// Keys of the section `sensor`.
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

/// Creates the key `sensor.frame_period`, which has an effect only for en-route frames.
Key frame_period_key() {
  Key key = number_key(
      "sensor.frame_period", "s", between(0.05, 3600),
      [](auto& m) -> auto& { return m.sensor.options.frame_period; },
      "Capture interval of en-route frames (sensor.capture: moving). The camera rotates between "
      "frames, not during the exposure; the vehicle does not stop.");
  key.fallback = "1 s";
  key.get = [get = key.get](const MissionDocument& mission) -> std::optional<KeyValue> {
    return mission.sensor.options.is_moving() ? get(mission) : std::nullopt;
  };
  return key;
}

/// Creates the key `sensor.lidar`, which replaces the camera by a scanner.
Key lidar_key() {
  return otherwise(
      "-", text_key(
               "sensor.lidar", [](auto& m) -> auto& { return m.sensor.lidar; },
               "Laser scanner instead of a depth camera: a preset of sim/sensors/presets, or the "
               "path of a sensor file (NAME.yaml), relative to the mission file. With a vehicle, "
               "it measures along the whole route, mounted as in scan.mount. Without a vehicle, it "
               "stops at each view for one revolution or half a second. A single-line LiDAR "
               "requires a vehicle. Only capture and frame_period of the section sensor apply."));
}

/// The key `sensor.photo_camera`, whose camera takes the depth camera's place.
Key photo_camera_key() {
  return otherwise(
      "-", text_key(
               "sensor.photo_camera", [](auto& m) -> auto& { return m.sensor.photo_camera; },
               "Photo camera instead of a depth camera: a preset of survey/photo/presets, or the "
               "path of a camera file (NAME.yaml), relative to the mission file. Photos are "
               "planned for photogrammetry (section photo) of the targets in the prior data (prior "
               "with role: target). No other key of the section sensor applies."));
}

}  // namespace

std::vector<Key> sensor_keys() {
  return {
      text_key(
          "sensor.preset", [](auto& m) -> auto& { return m.sensor.preset; },
          "Camera preset (skycap presets) whose values the keys below override. d435: Intel "
          "RealSense D435 as modelled in the paper (848 x 480 pixels, 69.4 x 42.5 degrees, no "
          "maximum range); intel_d435: the same camera with its real errors and range. "
          "high_resolution: the paper's camera for buildings (2400 x 1750 pixels, 60 x 40 "
          "degrees). For LiDAR presets, see sensor.lidar."),
      lidar_key(),
      photo_camera_key(),
      integer_key("sensor.width", "px", between(1, 32768), image(&geometry::CameraConfig::width),
                  "Image width."),
      integer_key("sensor.height", "px", between(1, 32768), image(&geometry::CameraConfig::height),
                  "Image height."),
      angle_key("sensor.horizontal_fov_deg", between(0.1, 179),
                image(&geometry::CameraConfig::horizontal_fov), "Full horizontal field of view."),
      angle_key("sensor.vertical_fov_deg", between(0.1, 179),
                image(&geometry::CameraConfig::vertical_fov), "Full vertical field of view."),
      number_key("sensor.min_range", "m", between(0, 1e6),
                 image(&geometry::CameraConfig::min_range),
                 "Minimum depth along the optical axis."),
      number_key("sensor.max_range", "m", above(0, 1e6), image(&geometry::CameraConfig::max_range),
                 "Maximum depth along the optical axis."),
      angle_key(
          "sensor.max_incidence_deg", above(0, 90),
          [](auto& m) -> auto& { return m.sensor.options.camera.max_incidence; },
          "Maximum angle of incidence: surfaces with a larger angle between normal and ray produce "
          "no return. 90: no limit."),
      number_key(
          "sensor.exposure", "s", between(0, 10),
          [](auto& m) -> auto& { return m.sensor.options.shutter.exposure; },
          "Exposure time of an image. With a vehicle, the time per capture is at least the "
          "exposure plus the readout time; the summary states the motion blur."),
      number_key(
          "sensor.readout", "s", between(0, 10),
          [](auto& m) -> auto& { return m.sensor.options.shutter.readout; },
          "Rolling-shutter readout time, from the exposure of the first row to that of the last. "
          "0: global shutter."),
      number_key(
          "sensor.settle", "s", between(0, 3600),
          [](auto& m) -> auto& { return m.sensor.options.settle; },
          "Minimum time at rest before the capture; flight.hold may be longer."),
      choice_key(
          "sensor.capture", {"stops", "moving"},
          [](auto& m) -> auto& { return m.sensor.options.capture; },
          "Capture mode of a survey with a vehicle. stops: at views only. moving: also en route "
          "between "
          "views; requires a vehicle and the planner skycap."),
      frame_period_key(),
      number_key("sensor.noise.sigma", "m", between(0, 1e3), noise(&sim::NoiseConfig::sigma),
                 "Standard deviation of the Gaussian noise of the measured points."),
      choice_key("sensor.noise.direction", {"isotropic", "along_ray"},
                 noise(&sim::NoiseConfig::direction),
                 "Direction of the noise: isotropic in x, y and z, or along the ray only."),
  };
}

}  // namespace skycap::missions::config
