#include "flight/calibration/calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "flight/calibration/power_fit.h"
#include "flight/export/geodesy.h"
#include "flight/export/mission_items.h"
#include "flight/export/text.h"
#include "flight/motion/hover_power.h"
#include "flight/motion/motion.h"
#include "geometry/angle.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double degree = geometry::radians_per_degree;

/// Minimum time of one kind of flight in a log [s], with its condition and a flight that provides
/// it.
struct Needed {
  const char* what;
  double time;
  bool (*is_it)(const Vector3d& velocity);
  const char* remedy;
};

bool is_hover(const Vector3d& v) { return v.norm() < 0.5; }
bool is_cruise(const Vector3d& v) { return v.head<2>().norm() > 2.5 && std::abs(v.z()) < 0.5; }
bool is_any(const Vector3d&) { return true; }

constexpr std::array needed{
    Needed{"steady flight", 120.0, is_any,
           "hover for 60 s and fly 4 level legs of 100 m at 5 m/s, one in each direction"},
    Needed{"hovering", 20.0, is_hover, "hover in place for 30 s"},
    Needed{"level flight faster than 2.5 m/s", 30.0, is_cruise,
           "fly 4 level legs of 100 m at 5 m/s, one in each direction"}};

/// Maximum scatter and maximum error on unseen parts, relative to the hover power. Fits above these
/// limits are rejected.
constexpr double max_scatter = 0.2, max_unseen_error = 0.3;

double total_time(const std::vector<LogWindow>& windows, const Needed& kind) {
  double time = 0.0;
  for (const LogWindow& window : windows) {
    if (std::ranges::all_of(window.velocities, kind.is_it)) time += window.duration;
  }
  return time;
}

void require_enough(const std::vector<LogWindow>& windows) {
  for (const Needed& kind : needed) {
    const double time = total_time(windows, kind);
    if (time >= kind.time) continue;
    throw Error(ErrorKind::bad_file, "contains " + fixed(time, 0) + " s of " + kind.what +
                                         "; required: at least " + fixed(kind.time, 0) +
                                         " s: " + kind.remedy);
  }
}

/// Throws if the current sensor is missing or broken: it then reads zero or a constant offset.
void require_power(const std::vector<LogSample>& samples) {
  constexpr double min_power = 1.0;  // Minimum plausible power [W].
  const auto is_some = [](const LogSample& sample) { return sample.power > min_power; };
  const auto count = static_cast<std::size_t>(std::ranges::count_if(samples, is_some));
  if (2 * count > samples.size()) return;
  throw Error(ErrorKind::bad_file,
              "contains no power measurements: current or voltage is zero in " +
                  std::to_string(samples.size() - count) + " of " + std::to_string(samples.size()) +
                  " readings; a current sensor is required (BATT_MONITOR 4 or higher)");
}

/// Returns the logged hover power, converted to sea level [W].
double measured_hover(const std::vector<LogWindow>& windows, double air_density) {
  std::vector<double> powers;
  for (const LogWindow& window : windows) {
    if (std::ranges::all_of(window.velocities, is_hover)) powers.push_back(window.power);
  }
  constexpr double sea_level = 1.225;
  return median(powers) * std::sqrt(air_density / sea_level);
}

std::string to_string(const Vehicle& vehicle) {
  return fixed(vehicle.mass, 2) + " kg on " + std::to_string(vehicle.rotors) + " rotors of " +
         fixed(vehicle.rotor_diameter, 3) + " m";
}

/// Returns the vehicle with the given mass, if any, and rotors that can carry it at the hover
/// power.
Vehicle with_mass(Vehicle vehicle, std::optional<double> mass, double hover_power,
                  std::vector<std::string>& warnings) {
  const double preset = vehicle.mass;
  vehicle.mass = mass.value_or(preset);
  const auto is_physical = [&] { return hover_power > 1.01 * min_rotor_power(vehicle); };
  if (is_physical()) return vehicle;
  const Vehicle initial = vehicle;
  if (mass && *mass > preset) {
    vehicle.rotor_diameter *= std::sqrt(*mass / preset);  // Equal disc loading.
    if (is_physical()) {
      warnings.push_back("rotor_diameter is set to " + fixed(vehicle.rotor_diameter, 3) +
                         " m: " + to_string(initial) + " need at least " +
                         fixed(min_rotor_power(initial), 0) + " W to hover, but the log shows " +
                         fixed(hover_power, 0) +
                         " W; set the rotor diameter of the logged vehicle");
      return vehicle;
    }
  }
  throw Error(
      ErrorKind::bad_file,
      "hover power of " + fixed(hover_power, 1) + " W is too low: " + to_string(initial) +
          " need at least " + fixed(min_rotor_power(initial), 1) +
          " W; set the take-off mass (--mass) or calibrate the current sensor (BATT_AMP_PERVLT)");
}

/// Returns the relative energy error of each fifth of the windows, predicted by a fit of the others
/// (RMS).
double cross_validation_error(const std::vector<LogWindow>& windows, const Vehicle& vehicle,
                              double air_density, double hover_power) {
  constexpr std::size_t parts = 5;
  double squares = 0.0;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = windows.size() * part / parts,
                      end = windows.size() * (part + 1) / parts;
    std::vector<LogWindow> others(windows.begin(),
                                  windows.begin() + static_cast<std::ptrdiff_t>(begin));
    others.insert(others.end(), windows.begin() + static_cast<std::ptrdiff_t>(end), windows.end());
    const PowerFit fit = fit_power(others, vehicle, air_density, hover_power);
    double measured = 0.0, modelled = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      measured += windows[i].duration * windows[i].power;
      modelled += windows[i].duration * modelled_power(fit, windows[i], air_density);
    }
    squares += std::pow(modelled / measured - 1.0, 2);
  }
  return std::sqrt(squares / static_cast<double>(parts));
}

void require_fit(const Calibration& fit) {
  if (fit.scatter > max_scatter * fit.hover_power) {
    throw Error(ErrorKind::bad_file,
                "does not fit a power model: the residual scatter (" + fixed(fit.scatter, 0) +
                    " W) exceeds " + fixed(100.0 * max_scatter, 0) + "% of the hover power (" +
                    fixed(fit.hover_power, 0) +
                    " W); check the current sensor or calibrate with another log");
  }
  if (fit.energy_error > max_unseen_error) {
    throw Error(
        ErrorKind::bad_file,
        "does not fit a power model: the energy of individual parts of the log differs by up to " +
            fixed(100.0 * fit.energy_error, 0) +
            "% from a fit to the other parts; calibrate with a flight on one battery in "
            "steady wind");
  }
}

std::vector<std::string> make_warnings(const PowerFit& fit, const Vehicle& vehicle) {
  std::vector<std::string> warnings;
  for (const std::string& name : fit.at_bound) {
    if (name == "rotors") {
      warnings.push_back(
          "rotor efficiency is at its limit of 1; the assumed vehicle (" + to_string(vehicle) +
          ") may differ from the logged one; set --mass and check the current sensor");
    } else {
      warnings.push_back(name +
                         " is at its limit of 0, because the log contains too little data to "
                         "estimate it; fly level legs at several speeds up to 8 m/s");
    }
  }
  return warnings;
}

/// ArduCopter parameter for a limit of its mission mode, with its unit. Values above `largest`, ten
/// times the maximum of ArduPilot's descriptions, are damaged.
struct ModeParameter {
  const char* name;
  double MissionMode::*field;
  double unit;
  double largest = 200.0;
};

// Names before version 4.7 and since.
constexpr std::array mode_parameters{
    ModeParameter{"WPNAV_SPEED_UP", &MissionMode::max_ascent, 0.01},
    ModeParameter{"WP_SPD_UP", &MissionMode::max_ascent, 1},
    ModeParameter{"WPNAV_SPEED_DN", &MissionMode::max_descent, 0.01},
    ModeParameter{"WP_SPD_DN", &MissionMode::max_descent, 1},
    ModeParameter{"WPNAV_ACCEL", &MissionMode::acceleration, 0.01},
    ModeParameter{"WP_ACC", &MissionMode::acceleration, 1},
    ModeParameter{"WPNAV_ACCEL_Z", &MissionMode::vertical_acceleration, 0.01},
    ModeParameter{"WP_ACC_Z", &MissionMode::vertical_acceleration, 1},
    ModeParameter{"WPNAV_JERK", &MissionMode::jerk, 1},
    ModeParameter{"WP_JERK", &MissionMode::jerk, 1},
    ModeParameter{"ATC_INPUT_TC", &MissionMode::jerk_rise, 2},
    ModeParameter{"ATC_SLEW_YAW", &MissionMode::yaw_rate, 0.01 * degree},
    ModeParameter{"ATC_RATE_WPY_MAX", &MissionMode::yaw_rate, degree},
    ModeParameter{"ATC_ACCEL_Y_MAX", &MissionMode::yaw_acceleration, 0.01 * degree},
    ModeParameter{"ATC_ACC_Y_MAX", &MissionMode::yaw_acceleration, degree},
    ModeParameter{"LAND_SPEED", &MissionMode::landing_speed, 0.01},
    ModeParameter{"LAND_SPD_MS", &MissionMode::landing_speed, 1},
    ModeParameter{"LAND_ALT_LOW", &MissionMode::landing_height, 0.01},
    ModeParameter{"LAND_ALT_LOW_M", &MissionMode::landing_height, 1}};

constexpr double min_limit = 1e-3;

std::size_t apply_parameters(const std::vector<LogParameter>& parameters, MissionMode& mode) {
  std::size_t measured = 0;
  for (const LogParameter& parameter : parameters) {
    const auto known = std::ranges::find_if(
        mode_parameters, [&](const auto& m) { return parameter.name == m.name; });
    if (known == mode_parameters.end()) continue;
    const double value = known->unit * parameter.value;
    if (!(value > min_limit && value < known->largest)) continue;
    mode.*(known->field) = value;
    ++measured;
  }
  return measured;
}

/// Excess of the legs that ended in a stop over their law [s]. Legs faster than half the law are
/// invalid, because they were not flown at the logged time.
struct LegTimes {
  std::vector<double> excesses;
  std::size_t without_time = 0;
};

LegTimes settlings(const std::vector<LogCommand>& commands, const Vehicle& vehicle) {
  constexpr int last_navigation = 95;
  LegTimes times;
  std::vector<Vector3d> path;  // End points of the legs since take-off.
  const LogCommand* active_command = nullptr;
  Conditions conditions;
  conditions.cruise_speed = std::min(conditions.cruise_speed, vehicle.max_speed);
  std::optional<LocalFrame> frame;
  for (const LogCommand& item : commands) {
    const bool is_ground_speed = item.first_parameter == 0.0 || item.first_parameter == 1.0;
    if (item.command == command::change_speed && is_ground_speed && item.second_parameter > 0.0) {
      conditions.cruise_speed = std::min(item.second_parameter, vehicle.max_speed);
    }
    if (item.command > last_navigation) continue;
    if (!frame && item.latitude_deg != 0.0) {
      frame.emplace(GeodeticPoint{item.latitude_deg, item.longitude_deg, 0.0});
    }
    if (active_command != nullptr && frame) {
      const Vector3d end = frame->to_local(
          {active_command->latitude_deg, active_command->longitude_deg, active_command->height});
      const bool stops = active_command->first_parameter > 0.0 || item.command == command::delay;
      if (!path.empty() && stops && (end - path.back()).norm() > 1.0) {
        const Motion motion(vehicle, conditions);
        const double predicted = motion.leg_time(end - path.back()) - vehicle.mode.settle_time;
        const double flight_time =
            item.time - active_command->time - active_command->first_parameter;
        if (flight_time < 0.5 * predicted) {
          ++times.without_time;
        } else {
          times.excesses.push_back(flight_time - predicted);
        }
      }
      path.push_back(end);
    }
    active_command = item.command == command::waypoint ? &item : nullptr;
    if (item.command == command::takeoff || item.command == command::land) path.clear();
  }
  return times;
}

}  // namespace

Calibration calibrate(const FlightLog& log, const Vehicle& preset, double air_density,
                      std::optional<double> mass) {
  require_power(log.samples);
  const std::vector<LogSample> samples = without_outliers(log.samples);
  const std::vector<LogWindow> windows = find_windows(samples);
  require_enough(windows);
  const double hover_power = measured_hover(windows, air_density);
  std::vector<std::string> warnings;
  const Vehicle vehicle = with_mass(preset, mass, hover_power, warnings);
  const PowerFit fit = fit_power(windows, vehicle, air_density, hover_power);
  Calibration result{.vehicle = fit.vehicle, .wind = fit.wind, .windows = windows.size()};
  result.outliers = log.samples.size() - samples.size() + log.damaged;
  for (const std::string& warning : make_warnings(fit, vehicle)) warnings.push_back(warning);
  result.warnings = std::move(warnings);
  double squares = 0.0;
  for (const LogWindow& window : windows) {
    result.flight_time += window.duration;
    squares += std::pow(modelled_power(fit, window, air_density) - window.power, 2);
  }
  result.scatter = std::sqrt(squares / static_cast<double>(windows.size()));
  // The fits of the parts start from the complete fit, which is close.
  result.energy_error =
      cross_validation_error(windows, fit.vehicle, air_density, data_sheet_power(fit.vehicle));
  result.vehicle.energy_error = std::clamp(2.0 * result.energy_error, min_energy_error, 0.9);
  result.hover_power = Motion(result.vehicle, {.cruise_speed = vehicle.max_speed}).hover_power();
  require_fit(result);

  constexpr std::size_t min_legs = 5;
  result.parameters = apply_parameters(log.parameters, result.vehicle.mode);
  const LegTimes times = settlings(log.commands, result.vehicle);
  result.legs = times.excesses.size();
  result.legs_without_time = times.without_time;
  if (result.legs >= min_legs) {
    result.settling = std::clamp(median(times.excesses), 0.0, 60.0);
    result.vehicle.mode.settle_time = *result.settling;
  }
  return result;
}

}  // namespace skycap::flight
