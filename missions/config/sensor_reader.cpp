#include "missions/config/sensor_reader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/config/preset_files.h"
#include "missions/support/yaml_section.h"

namespace skycap::missions::config {
namespace {

constexpr double degree = geometry::radians_per_degree;
// Factor sqrt(2 / ln 2): full width at half maximum to 1/e^2.
constexpr double fwhm_to_full_width = 1.69864;

constexpr std::size_t longest_name = 60;  // in a message

/// The name of a preset's file for the short names of the experiments' cameras.
std::string preset_name(const std::string& name) {
  return name == "d435" || name == "high_resolution" ? "see_" + name : name;
}

/// The values of a list that is as long as the channels, or of none.
void set_each(support::YamlSection& section, const std::string& key,
              std::vector<sim::Channel>& channels, double sim::Channel::*field, double unit) {
  const std::vector<double> values = section.numbers(key);
  if (!section.has(key)) return;
  if (values.size() != channels.size()) {
    section.fail_at(key, "has " + std::to_string(values.size()) + " numbers for " +
                             std::to_string(channels.size()) + " channels");
  }
  for (std::size_t i = 0; i < values.size(); ++i) channels[i].*field = unit * values[i];
}

std::vector<sim::Channel> read_channels(support::YamlSection section) {
  std::vector<sim::Channel> channels;
  if (section.has("count")) {  // evenly spaced from top to bottom, as sensors number channels
    const int count = section.integer("count", 1);
    if (count < 2 || count > 1024) section.fail_at("count", "must be between 2 and 1024");
    const double min_elevation = section.number("lowest_deg"),
                 max_elevation = section.number("highest_deg");
    const double height = 1e-3 * section.number("height_mm", 0.0);
    for (int i = 0; i < count; ++i) {
      const double elevation = max_elevation + (min_elevation - max_elevation) * i / (count - 1);
      channels.push_back({.elevation = elevation * degree, .height = height});
    }
  } else {
    channels.resize(section.numbers("elevation_deg").size());
    if (channels.empty()) section.fail_at("elevation_deg", "must list one angle for each channel");
    set_each(section, "elevation_deg", channels, &sim::Channel::elevation, degree);
    set_each(section, "azimuth_deg", channels, &sim::Channel::azimuth, degree);
    set_each(section, "delay_us", channels, &sim::Channel::delay, 1e-6);
    set_each(section, "height_mm", channels, &sim::Channel::height, 1e-3);
  }
  section.finish();
  return channels;
}

sim::WedgePrism read_prism(support::YamlSection section) {
  sim::WedgePrism prism;
  prism.wedge = degree * section.number("wedge_deg");
  prism.refractive_index = section.number("refractive_index", prism.refractive_index);
  prism.rotation_rate = section.number("rotation_rate_hz");
  prism.phase = degree * section.number("phase_deg", 0.0);
  prism.is_inclined_at_entry = section.choice<bool>("inclined", {{"entry", true}, {"exit", false}});
  section.finish();
  return prism;
}

sim::NoiseTable read_noise_table(support::YamlSection section) {
  sim::NoiseTable table;
  table.ranges = section.numbers("range");
  table.incidences = section.numbers("incidence_deg");
  for (double& incidence : table.incidences) incidence *= degree;
  table.reflectances = section.numbers("reflectance");
  table.sigmas = section.numbers("sigma");
  if (table.ranges.empty()) section.fail_at("range", "must list at least one range");
  if (table.sigmas.empty()) section.fail_at("sigma", "must list the standard deviations");
  // Without an axis, the noise does not depend on it.
  if (table.incidences.empty()) table.incidences = {0.0};
  if (table.reflectances.empty()) table.reflectances = {1.0};
  section.finish();
  return table;
}

sim::RangeErrors read_errors(support::YamlSection section) {
  sim::RangeErrors errors;
  errors.sigma = section.number("sigma", 0.0);
  errors.sigma_per_metre = section.number("sigma_per_metre", 0.0);
  errors.sigma_per_square_metre = section.number("sigma_per_square_metre", 0.0);
  errors.incidence_power = section.number("incidence_power", 0.0);
  if (auto table = section.section("table")) {
    for (const char* const key :
         {"sigma", "sigma_per_metre", "sigma_per_square_metre", "incidence_power"}) {
      if (section.has(key)) section.fail_at(key, "conflicts with table; remove one of them");
    }
    errors.table = read_noise_table(*table);
  }
  errors.channel_bias_sigma = section.number("channel_bias_sigma", 0.0);
  errors.range_step = section.number("range_step", 0.0);
  errors.angle_sigma = degree * section.number("angle_sigma_deg", 0.0);
  section.finish();
  return errors;
}

sim::Sensitivity read_sensitivity(support::YamlSection section) {
  sim::Sensitivity sensitivity;
  sensitivity.reference_range = section.number("range");
  sensitivity.reference_reflectance = section.number("reflectance");
  sensitivity.attenuation = section.number("attenuation", 0.0);
  section.finish();
  return sensitivity;
}

void read_beam(support::YamlSection section, sim::Beam& beam) {
  const double unit =
      section.choice<double>("width", {{"fwhm", fwhm_to_full_width}, {"1/e2", 1.0}});
  const auto angle = [&](const std::string& name) {
    return unit * (section.has(name + "_deg") ? degree * section.number(name + "_deg")
                                              : 1e-3 * section.number(name + "_mrad"));
  };
  beam.divergence_horizontal = angle("horizontal");
  beam.divergence_vertical = angle("vertical");
  beam.rings = section.integer("rings", 0);
  beam.pulse_length = 1e-9 * section.number("pulse_ns", 1e9 * beam.pulse_length);
  section.finish();
}

void read_returns(support::YamlSection section, sim::Beam& beam) {
  using sim::EchoChoice;
  beam.max_returns = section.integer("max", 1);
  beam.choice = section.choice<EchoChoice>(
      "choice", {{"first", EchoChoice::first},
                 {"strongest", EchoChoice::strongest},
                 {"last", EchoChoice::last},
                 {"strongest_and_last", EchoChoice::strongest_and_last}});
  section.finish();
}

sim::LidarConfig read_lidar(support::YamlSection& root, bool is_rosette) {
  sim::LidarConfig config;
  config.rotation_rate = 0.0;
  if (is_rosette) {
    for (const support::YamlSection& prism : root.sections("prisms"))
      config.prisms.push_back(read_prism(prism));
    if (config.prisms.empty()) root.fail_at("prisms", "must list the rosette's prisms");
  } else {
    config.rotation_rate = root.number("rotation_rate_hz");
    config.radial_offset = 1e-3 * root.number("radial_offset_mm", 0.0);
  }
  if (!is_rosette && root.has("columns_per_turn")) {
    config.firing_period = 1.0 / (config.rotation_rate * root.number("columns_per_turn"));
  } else {
    config.firing_period = 1e-6 * root.number("firing_period_us");
  }
  if (!is_rosette && root.boolean("clockwise", false)) config.rotation_rate *= -1.0;
  if (auto channels = root.section("channels")) config.channels = read_channels(*channels);
  config.field_of_view = degree * root.number("field_of_view_deg", 360.0);
  if (auto range = root.section("range")) {
    config.min_range = range->number("min");
    config.max_range = range->number("max");
    range->finish();
  }
  if (auto errors = root.section("errors")) config.errors = read_errors(*errors);
  if (auto section = root.section("sensitivity")) config.sensitivity = read_sensitivity(*section);
  if (auto beam = root.section("beam")) read_beam(*beam, config.beam);
  if (auto returns = root.section("returns")) read_returns(*returns, config.beam);
  return config;
}

sim::DepthCameraConfig read_camera(support::YamlSection& root,
                                   std::optional<RangeInterval>& useful_range) {
  sim::DepthCameraConfig config;
  config.camera.width = root.integer("width_px", config.camera.width);
  config.camera.height = root.integer("height_px", config.camera.height);
  config.camera.horizontal_fov = degree * root.number("horizontal_fov_deg");
  config.camera.vertical_fov = degree * root.number("vertical_fov_deg");
  config.max_incidence = degree * root.number("max_incidence_deg", 90.0);
  if (auto range = root.section("range")) {
    config.camera.min_range = range->number("min");
    config.camera.max_range = range->number("max");
    range->finish();
  }
  if (auto useful = root.section("useful_range")) {
    useful_range = RangeInterval{useful->number("min"), useful->number("max")};
    if (!(useful_range->min >= 0.0 && useful_range->min < useful_range->max)) {
      useful->fail_at("max", "must be greater than min, which must be zero or more");
    }
    useful->finish();
  }
  if (auto noise = root.section("noise")) {
    if (auto table = noise->section("table")) {
      config.noise.table = read_noise_table(*table);
      config.noise.sigma = noise->number("sigma", 0.0);
    } else {
      config.noise.sigma = noise->number("sigma");
    }
    if (!config.noise.table.is_on() || noise->has("direction")) {
      config.noise.direction = noise->choice<sim::NoiseDirection>(
          "direction", {{"isotropic", sim::NoiseDirection::isotropic},
                        {"along_ray", sim::NoiseDirection::along_ray}});
    }
    noise->finish();
  }
  if (auto stereo = root.section("stereo")) {
    config.stereo.focal_length_px = stereo->number("focal_length_px");
    config.stereo.baseline = stereo->number("baseline");
    config.stereo.disparity_sigma_px = stereo->number("disparity_sigma_px");
    config.stereo.disparity_step_px = stereo->number("disparity_step_px", 0.0);
    stereo->finish();
  }
  return config;
}

bool is_camera(const SensorDescription& description) {
  return std::holds_alternative<sim::DepthCameraConfig>(description.sensor);
}

std::string camera_names() {
  std::string names = "d435, high_resolution";
  for (const std::string_view name : sensor_presets()) {
    if (is_camera(find_sensor(std::string(name)))) names += ", " + std::string(name);
  }
  return names;
}

}  // namespace

SensorDescription read_sensor(const std::string& text, const std::string& file) {
  const support::YamlNode tree = support::parse_yaml(text, file);
  support::YamlSection root(tree, "", file);
  SensorDescription description;
  description.name = root.text("name");
  description.text = text;
  enum class Kind { spinning, rosette, camera };
  const Kind kind = root.choice<Kind>(
      "kind", {{"spinning", Kind::spinning}, {"rosette", Kind::rosette}, {"camera", Kind::camera}});
  if (kind == Kind::camera) {
    description.sensor = read_camera(root, description.useful_range);
  } else {
    description.sensor = read_lidar(root, kind == Kind::rosette);
  }
  constexpr int max_payload = 99999;
  description.wpml_payload = root.integer("wpml_payload", 0, 0, max_payload);
  root.finish();
  try {
    std::visit([](const auto& config) { config.validate(); }, description.sensor);
  } catch (const Error& error) {  // add the file name
    throw Error(error.kind(), file + ": " + error.what());
  }
  return description;
}

std::vector<std::string_view> sensor_presets() {
  std::vector<std::string_view> names;
  for (const PresetFile& preset : sensor_preset_files()) names.push_back(preset.name);
  return names;
}

SensorDescription find_sensor(const std::string& name_or_file) {
  const std::string known = preset_name(name_or_file);
  const PresetText found = preset_text("sensor", known, sensor_preset_files());
  return read_sensor(found.text, found.file);
}

SensorDescription find_camera(const std::string& name) {
  const auto reject = [](const std::string& what) { throw Error(ErrorKind::bad_config, what); };
  if (name.ends_with(".yaml")) {
    reject(
        "must be the name of a preset; set the values of another camera with the other keys of "
        "sensor");
  }
  const std::string preset = preset_name(name);
  const std::vector<std::string_view> known = sensor_presets();
  if (std::ranges::find(known, preset) == known.end()) {
    reject("unknown camera " + name.substr(0, longest_name) +
           "; expected one of: " + camera_names());
  }
  SensorDescription description = find_sensor(preset);
  if (!is_camera(description)) {
    reject(name + " is a LiDAR; set sensor.lidar: " + name + " instead of sensor.preset");
  }
  return description;
}

}  // namespace skycap::missions::config
