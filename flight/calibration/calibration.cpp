#include "flight/calibration/calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "flight/calibration/power_fit.h"
#include "flight/export/geodesy.h"
#include "flight/export/mission_items.h"
#include "flight/export/text.h"
#include "flight/motion/motion.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180.0;

/// How much of a kind of flight a log must hold [s], and what is counted as that kind.
struct Needed {
  const char* what;
  double time;
  bool (*is_it)(const Vector3d& velocity);
};

bool is_hover(const Vector3d& v) { return v.norm() < 0.5; }
bool is_cruise(const Vector3d& v) { return v.head<2>().norm() > 2.5 && std::abs(v.z()) < 0.5; }
bool is_any(const Vector3d&) { return true; }

constexpr std::array needed{Needed{"steady flight", 120.0, is_any},
                            Needed{"hovering", 20.0, is_hover},
                            Needed{"level flight faster than 2.5 m/s", 30.0, is_cruise}};

double time_of(const std::vector<LogWindow>& windows, const Needed& kind) {
  double time = 0.0;
  for (const LogWindow& window : windows) {
    if (std::ranges::all_of(window.velocities, kind.is_it)) time += window.duration;
  }
  return time;
}

void require_enough(const std::vector<LogWindow>& windows) {
  for (const Needed& kind : needed) {
    const double time = time_of(windows, kind);
    if (time >= kind.time) continue;
    throw Error(ErrorKind::bad_file, "holds " + fixed(time, 0) + " s of " + kind.what +
                                         "; at least " + fixed(kind.time, 0) + " s are needed");
  }
}

/// The energy of each fifth of the windows by a fit of the others, against what it took.
double unseen_error(const std::vector<LogWindow>& windows, const Vehicle& vehicle,
                    double air_density) {
  constexpr std::size_t parts = 5;
  double squares = 0.0;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = windows.size() * part / parts,
                      end = windows.size() * (part + 1) / parts;
    std::vector<LogWindow> others(windows.begin(),
                                  windows.begin() + static_cast<std::ptrdiff_t>(begin));
    others.insert(others.end(), windows.begin() + static_cast<std::ptrdiff_t>(end), windows.end());
    const PowerFit fit = fit_power(others, vehicle, air_density);
    double taken = 0.0, modelled = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      taken += windows[i].duration * windows[i].power;
      modelled += windows[i].duration * modelled_power(fit, windows[i], air_density);
    }
    squares += std::pow(modelled / taken - 1.0, 2);
  }
  return std::sqrt(squares / static_cast<double>(parts));
}

/// A parameter of ArduCopter that is a limit of its mission mode, in our units.
struct ModeParameter {
  const char* name;
  double MissionMode::*field;
  double unit;
};

// Both names, before 4.7 and since.
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

std::size_t take_over(const std::vector<LogParameter>& parameters, MissionMode& mode) {
  std::size_t taken = 0;
  for (const LogParameter& parameter : parameters) {
    const auto known = std::ranges::find_if(
        mode_parameters, [&](const auto& m) { return parameter.name == m.name; });
    if (known == mode_parameters.end() || !(parameter.value > 0.0)) continue;
    mode.*(known->field) = known->unit * parameter.value;
    ++taken;
  }
  return taken;
}

/// What each leg that ended in a stop took beyond its law [s].
std::vector<double> settlings(const std::vector<LogCommand>& commands, const Vehicle& vehicle) {
  constexpr int last_navigation = 95;
  std::vector<double> excesses;
  std::vector<Vector3d> way;  // where legs have ended since take-off
  const LogCommand* under_way = nullptr;
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
    if (under_way != nullptr && frame) {
      const Vector3d end =
          frame->to_local({under_way->latitude_deg, under_way->longitude_deg, under_way->height});
      const bool stops = under_way->first_parameter > 0.0 || item.command == command::delay;
      if (!way.empty() && stops && (end - way.back()).norm() > 1.0) {
        const Motion motion(vehicle, conditions);
        const double law = motion.leg_time(end - way.back()) - vehicle.mode.settle_time;
        excesses.push_back(item.time - under_way->time - under_way->first_parameter - law);
      }
      way.push_back(end);
    }
    under_way = item.command == command::waypoint ? &item : nullptr;
    if (item.command == command::takeoff || item.command == command::land) way.clear();
  }
  return excesses;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

}  // namespace

Calibration calibrate(const FlightLog& log, const Vehicle& vehicle, double air_density) {
  const std::vector<LogWindow> windows = windows_of(log.samples);
  require_enough(windows);
  const PowerFit fit = fit_power(windows, vehicle, air_density);
  Calibration result{.vehicle = fit.vehicle, .wind = fit.wind, .windows = windows.size()};
  double squares = 0.0;
  for (const LogWindow& window : windows) {
    result.flown += window.duration;
    squares += std::pow(modelled_power(fit, window, air_density) - window.power, 2);
  }
  result.scatter = std::sqrt(squares / static_cast<double>(windows.size()));
  result.energy_error = unseen_error(windows, vehicle, air_density);
  result.vehicle.energy_error = std::clamp(2.0 * result.energy_error, least_energy_error, 0.9);
  result.hover_power = Motion(result.vehicle, {.cruise_speed = vehicle.max_speed}).hover_power();

  constexpr std::size_t least_legs = 5;
  result.parameters = take_over(log.parameters, result.vehicle.mode);
  const std::vector<double> excesses = settlings(log.commands, result.vehicle);
  result.legs = excesses.size();
  if (excesses.size() >= least_legs) {
    result.settling = std::clamp(median(excesses), 0.0, 60.0);
    result.vehicle.mode.settle_time = *result.settling;
  }
  return result;
}

}  // namespace skycap::flight
