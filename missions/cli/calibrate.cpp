#include <cmath>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "flight/calibration/calibration.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/commands.h"
#include "missions/config/vehicle_reader.h"
#include "missions/support/number_text.h"

namespace skycap::missions::cli {
namespace {

using flight::Calibration;

/// Formats a number with the digits that are significant in a fit.
std::string figure(double value) { return fmt::format("{:.5g}", value); }

std::string vehicle_text(const Calibration& calibration, const std::string& preset,
                         const std::string& log, const std::string& name) {
  const flight::Vehicle& vehicle = calibration.vehicle;
  const flight::MissionMode& mode = vehicle.mode;
  constexpr double degree = geometry::radians_per_degree;
  return fmt::format(
      "# Fitted to {}: {} windows of steady flight, {:.0f} s, scatter {:.1f} W. Energy of the "
      "parts of\n# the log that were not used in the fit: predicted to within {:.1f}%.\nname: "
      "{}\nlike: {}\nmass: {}\nrotor_diameter: "
      "{}\nbattery_wh: {}\nendurance_min: {}\navionics_power: {}\ndrag_area: {}\nenergy_error: "
      "{}\nmode:\n  max_ascent: {}\n  max_descent: {}\n  acceleration: {}\n  "
      "vertical_acceleration: {}\n  jerk: {}\n  jerk_rise: {}\n  settle_time: {}\n  yaw_rate_deg: "
      "{}\n  yaw_acceleration_deg: {}\n  landing_speed: {}\n  landing_height: {}\n",
      log, calibration.windows, calibration.flight_time, calibration.scatter,
      100.0 * calibration.energy_error, name, preset, figure(vehicle.mass),
      figure(vehicle.rotor_diameter), figure(vehicle.battery_wh), figure(vehicle.endurance_min),
      figure(vehicle.avionics_power), figure(vehicle.drag_area), figure(vehicle.energy_error),
      figure(mode.max_ascent), figure(mode.max_descent), figure(mode.acceleration),
      figure(mode.vertical_acceleration), figure(mode.jerk), figure(mode.jerk_rise),
      figure(mode.settle_time), figure(mode.yaw_rate / degree),
      figure(mode.yaw_acceleration / degree), figure(mode.landing_speed),
      figure(mode.landing_height));
}

std::string report(const Calibration& calibration, const flight::Vehicle& before) {
  const flight::Vehicle& vehicle = calibration.vehicle;
  std::string text = fmt::format(
      "  power     hover {:.1f} W, {:.1f} min until the battery is empty (preset {:.1f}); avionics "
      "{:.1f} W, drag area {:.4f} m^2\n  fit       {} windows, {:.0f} s, scatter {:.1f} W; energy "
      "of unused parts predicted to within {:.1f}%; energy_error {:.2f}\n  wind      {:.1f} m/s "
      "during the "
      "flight\n",
      calibration.hover_power, vehicle.endurance_min, before.endurance_min, vehicle.avionics_power,
      vehicle.drag_area, calibration.windows, calibration.flight_time, calibration.scatter,
      100.0 * calibration.energy_error, vehicle.energy_error, calibration.wind.norm());
  if (calibration.outliers > 0) {
    text += fmt::format("  damage    {} readings skipped\n", calibration.outliers);
  }
  text += fmt::format("  times     from {} autopilot parameters", calibration.parameters);
  if (calibration.settling) {
    text += fmt::format(", settling time {:.2f} s from {} legs\n", *calibration.settling,
                        calibration.legs);
  } else if (calibration.legs_without_time > calibration.legs) {
    text += fmt::format(
        "; settle_time unchanged: the durations of {} legs are unknown (the log contains the "
        "mission, but not its execution)\n",
        calibration.legs_without_time);
  } else {
    text += fmt::format("; {} legs with a stop are too few to estimate the settling time\n",
                        calibration.legs);
  }
  for (const std::string& warning : calibration.warnings) text += "  Warning: " + warning + "\n";
  return text;
}

/// Throws Error{bad_file} if the fitted values are not valid in a vehicle file.
void require_readable(const std::string& text, const std::string& name) {
  try {
    config::read_vehicle(text, name);
  } catch (const Error& error) {
    throw Error(ErrorKind::bad_file,
                std::string("the fitted values do not describe a valid vehicle: ") + error.what());
  }
}

}  // namespace

int calibrate(const CalibrateOptions& options, const Console& console) {
  if (options.vehicle.ends_with(".yaml")) {
    throw Error(ErrorKind::bad_usage, "--vehicle is " + options.vehicle + "; it must be a preset");
  }
  flight::Vehicle vehicle = config::find_vehicle(options.vehicle);
  if (options.battery_wh) vehicle.battery_wh = *options.battery_wh;
  ProgressLine progress(console, false);
  progress.show("reading " + options.log.string());
  const flight::FlightLog log = flight::read_flight_log(options.log);
  progress.show("fitting " + options.vehicle + " to " + options.log.string());
  Calibration calibration;
  try {
    calibration = flight::calibrate(log, vehicle, options.air_density, options.mass);
  } catch (const Error& error) {
    throw Error(error.kind(), options.log.string() + ": " + error.what());
  }
  std::filesystem::path file = options.log;
  file = options.out.value_or(file.replace_extension(".yaml"));
  const std::string name = file.stem().string();
  const std::string text =
      vehicle_text(calibration, options.vehicle, options.log.filename().string(), name);
  require_readable(text, "the new vehicle file");
  geometry::OutputFolder folder(file.has_parent_path() ? file.parent_path() : ".");
  folder.write(file.filename().string(), text);
  folder.commit();
  progress.clear();
  console.out << name << ": like " << options.vehicle << ", from " << options.log.string() << "\n"
              << report(calibration, vehicle) << "  results   " << file.string() << "\n"
              << std::flush;
  return 0;
}

}  // namespace skycap::missions::cli
