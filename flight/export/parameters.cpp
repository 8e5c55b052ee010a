#include "flight/export/parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "flight/rtl/min_return_altitude.h"
#include "flight/rtl/rtl_profile.h"
#include "geometry/error.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

enum class Type { whole = 6, real = 9 };  ///< MAVLink type of a value.

/// Setting that an autopilot must have for its returns to equal the verified ones.
struct Requirement {
  const char* name;
  double min, max;
  double by_default;
  const char* other_name = "";  ///< Name of the same parameter in other versions.
};

constexpr std::array ardupilot_requirements{
    Requirement{"RTL_CONE_SLOPE", 0.0, 0.0, 3.0},
    Requirement{"RTL_CLIMB_MIN", 0.0, 0.0, 0.0},
    Requirement{"RTL_CLIMB_MIN_M", 0.0, 0.0, 0.0},
    Requirement{"RTL_ALT_TYPE", 0.0, 0.0, 0.0},
    Requirement{"RTL_ALT_FINAL", 0.0, 0.0, 0.0},
    Requirement{"RTL_ALT_FINAL_M", 0.0, 0.0, 0.0},
    Requirement{"RALLY_INCL_HOME", 1.0, 1.0, 1.0},
    Requirement{"WPNAV_RADIUS", 5.0, 100.0 * ardupilot_waypoint_radius, 200.0, "WP_RADIUS_M"},
    // A missing radius is reported under the older name only.
    Requirement{"WP_RADIUS_M", 0.05, ardupilot_waypoint_radius, ardupilot_waypoint_radius},
};
constexpr std::array px4_requirements{
    Requirement{"RTL_TYPE", 0.0, 0.0, 0.0},
    Requirement{"RTL_CONE_ANG", 0.0, 0.0, 45.0},
    Requirement{"NAV_ACC_RAD", 0.05, px4_landing_radius, 10.0},
    Requirement{"NAV_MC_ALT_RAD", 0.05, acceptance_radius, 0.8},
};

std::span<const Requirement> requirements(AutopilotType autopilot) {
  if (autopilot == AutopilotType::ardupilot) return ardupilot_requirements;
  if (autopilot == AutopilotType::px4) return px4_requirements;
  return {};
}

/// Returns the shortest text of a number with up to four decimals.
std::string plain(double value) {
  std::string text = fixed(value, 4);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

/// Writes one file, section by section.
class ParameterWriter {
 public:
  ParameterWriter(const FlightPlan& plan, const Returns& returns)
      : plan_(plan), returns_(returns), is_px4_(plan.vehicle.autopilot == AutopilotType::px4) {}

  std::string write() {
    comment("Onboard parameters for Vehicle 1");
    comment("");
    comment("Mission \"" + plan_.name + "\": return altitude " + plain(returns_.height) +
            " m above take-off, verified at this altitude only.");
    comment(is_px4_ ? "Verified for PX4 1.14 to 1.18." : "Verified for ArduCopter 4.1 to 4.7.");
    if (is_px4_ && plan_.fence) {
      comment("Do not use PX4 1.19 or later: its returns fly around the fence.");
    }
    comment(
        "Order: load these parameters; restart the autopilot if the ground station requests it; "
        "read back");
    comment(std::string(is_px4_ ? "RTL_RETURN_ALT and RTL_CONE_ANG"
                                : "RTL_ALT (cm) or RTL_ALT_M (m), and RTL_CONE_SLOPE") +
            "; upload the fence, rally points and mission.");
    comment(
        "After arming, check that the home position is within 2 m of the take-off point; returns "
        "end there.");
    comment("");
    if (is_px4_) comment("Vehicle-Id Component-Id Name Value Type");
    is_px4_ ? write_px4() : write_ardupilot();
    return std::move(text_);
  }

 private:
  void comment(const std::string& line) { text_ += line.empty() ? "#\n" : "# " + line + "\n"; }

  void set(const std::string& name, double value, Type type = Type::whole) {
    if (is_px4_) {
      text_ += "1\t1\t" + name + "\t" + plain(value) + "\t" +
               std::to_string(static_cast<int>(type)) + "\n";
    } else {
      text_ += name + "," + plain(value) + "\n";
    }
  }
  void real(const std::string& name, double value) { set(name, value, Type::real); }

  /// Writes the old name in centimetres, and the name since version 4.7 in metres.
  void both(const std::string& old_name, const std::string& new_name, double metres) {
    set(old_name, std::round(100.0 * metres));
    set(new_name, metres);
  }

  /// Returns the fraction of the battery that the most expensive return needs. It is at most the
  /// reserve at landing, so that a flight as planned does not trigger the failsafe.
  double battery_share() const {
    const double full = plan_.vehicle.battery_wh * 3600.0;
    return std::max(0.07, std::min(1.2 * returns_.energy / full, plan_.conditions.reserve));
  }

  double ceiling() const {
    const bool has_ceiling = plan_.fence && std::isfinite(plan_.fence->ceiling);
    return has_ceiling ? plan_.fence->ceiling - plan_.pad.z() : 0.0;
  }

  void write_ardupilot() {
    comment(
        "Return: ArduPilot 4.6 and earlier use the parameters in centimetres; 4.7 and later use "
        "those in metres.");
    comment("The ground station may report that the other name of each pair is missing.");
    both("RTL_ALT", "RTL_ALT_M", returns_.height);
    set("RTL_CONE_SLOPE", 0);  // Otherwise it climbs less near home.
    both("RTL_CLIMB_MIN", "RTL_CLIMB_MIN_M", 0);
    both("RTL_ALT_FINAL", "RTL_ALT_FINAL_M", 0);  // Land.
    set("RTL_ALT_TYPE", 0);                       // Above home.
    set("RTL_OPTIONS", 0);
    set("RTL_LOIT_TIME", 5000);
    both("RTL_SPEED", "RTL_SPEED_MS", plan_.conditions.cruise_speed);
    comment("Mission speeds [m/s], accelerations [m/s^2] and jerk [m/s^3]");
    const MissionMode& mode = plan_.vehicle.mode;
    both("WPNAV_SPEED_UP", "WP_SPD_UP", mode.max_ascent);
    both("WPNAV_SPEED_DN", "WP_SPD_DN", mode.max_descent);
    both("WPNAV_ACCEL", "WP_ACC", mode.acceleration);
    both("WPNAV_ACCEL_Z", "WP_ACC_Z", mode.vertical_acceleration);
    set("WPNAV_JERK", mode.jerk);
    set("WP_JERK", mode.jerk);
    both("WPNAV_RADIUS", "WP_RADIUS_M", ardupilot_waypoint_radius);
    both("LAND_SPEED", "LAND_SPD_MS", mode.landing_speed);
    both("LAND_ALT_LOW", "LAND_ALT_LOW_M", mode.landing_height);
    set("WP_YAW_BEHAVIOR", 0);  // The mission sets the headings.
    set("OA_TYPE", 0);          // Only verified paths.
    comment("Loss of the link to the pilot or to the ground station: return");
    set("FS_THR_ENABLE", 1);
    set("FS_GCS_ENABLE", 1);
    set("FS_OPTIONS", 0);
    comment(
        "Battery low: return; critical: land in place. Set BATT_CAPACITY [mAh] to the battery "
        "capacity,");
    comment("BATT_LOW_MAH to " + plain(std::ceil(100.0 * battery_share())) +
            "% of it (maximum energy of a return), and BATT_CRT_MAH to the charge that a landing "
            "requires.");
    set("BATT_FS_LOW_ACT", 2);
    set("BATT_FS_CRT_ACT", 1);
    set("RALLY_INCL_HOME", 1);
    if (returns_.rtl_profile.landings.size() > 1) set("RALLY_LIMIT_KM", 0);  // Any distance.
    write_ardupilot_fence();
  }

  void write_ardupilot_fence() {
    if (!plan_.fence && plan_.no_fly.empty()) return;
    constexpr int altitude = 1, polygon = 4;
    comment("Fence: the polygons are in the .plan file. Breach: return. Returns are verified from");
    comment("points of the route only, not from outside the fence.");
    // ArduCopter returns at FENCE_ALT_MAX - FENCE_MARGIN if the return altitude is higher.
    constexpr double min_margin = 1.0, usual_margin = 2.0;
    const double margin =
        std::min(usual_margin, std::floor(ceiling()) - std::ceil(returns_.height));
    const bool has_altitude = ceiling() > 0.0 && margin >= min_margin;
    if (ceiling() > 0.0 && !has_altitude) {
      comment(
          "No maximum altitude: less than 1 m above the return altitude, it would lower returns.");
    }
    set("FENCE_ENABLE", 1);
    set("FENCE_TYPE", polygon + (has_altitude ? altitude : 0));
    set("FENCE_ACTION", 1);
    set("FENCE_MARGIN", has_altitude ? margin : usual_margin);
    if (has_altitude) set("FENCE_ALT_MAX", std::floor(ceiling()));
  }

  void write_px4() {
    set("RTL_TYPE", 0);  // Straight to home or a rally point.
    real("RTL_RETURN_ALT", returns_.height);
    set("RTL_CONE_ANG", 0);  // Otherwise it climbs less near home.
    real("RTL_MIN_DIST", 0.5);
    real("RTL_DESCEND_ALT", 10);
    real("RTL_LAND_DELAY", 0);
    real("NAV_ACC_RAD", px4_landing_radius);
    // Stops and the end of the take-off, which PX4 leaves within this distance, count as exact.
    real("NAV_MC_ALT_RAD", acceptance_radius);
    comment("Speeds [m/s], accelerations [m/s^2] and jerk [m/s^3]");
    real("MPC_XY_CRUISE", std::max(3.0, plan_.conditions.cruise_speed));
    const MissionMode& mode = plan_.vehicle.mode;
    real("MPC_Z_V_AUTO_UP", mode.max_ascent);
    real("MPC_Z_V_AUTO_DN", mode.max_descent);
    real("MPC_ACC_HOR", mode.acceleration);
    real("MPC_JERK_AUTO", mode.jerk);
    real("MPC_LAND_SPEED", mode.landing_speed);
    comment("The mission sets the headings; views are captured within 1 degree of their heading");
    set("MPC_YAW_MODE", 0);
    real("MIS_YAW_ERR", 1);
    real("MIS_YAW_TMT", -1);  // A timeout would accept waypoints without their heading.
    comment("Loss of the link to the pilot or to the ground station: return");
    set("NAV_RCL_ACT", 2);
    set("NAV_DLL_ACT", 2);
    set("COM_RCL_EXCEPT", 0);
    comment("Battery critical: return (threshold: maximum energy of a return). Emergency: land.");
    set("COM_LOW_BAT_ACT", 3);
    const double share = std::ceil(100.0 * battery_share()) / 100.0;
    real("BAT_CRIT_THR", share);
    real("BAT_LOW_THR", std::min(share + 0.05, 0.5));
    if (!plan_.fence && plan_.no_fly.empty()) return;
    comment("Fence: the polygons are in the .plan file. Breach: return. Returns are verified from");
    comment("points of the route only, not from outside the fence.");
    set("GF_ACTION", 3);
    if (ceiling() > 0.0) real("GF_MAX_VER_DIST", std::floor(ceiling()));
  }

  const FlightPlan& plan_;
  const Returns& returns_;
  bool is_px4_;
  std::string text_;
};

/// Parses the parameter in a line of either format. Returns std::nullopt without one.
///
/// Mission Planner separates name and value by a comma, MAVProxy by blanks. QGroundControl
/// separates five fields by tabs.
std::optional<Parameter> parameter_in(const std::string& line) {
  const std::vector<std::string> tabbed = split(line, '\t');
  const bool is_qgc = tabbed.size() == 5;
  std::vector<std::string> pair = split(line, ',');
  if (pair.size() != 2) pair = geometry::split_words(line);
  if (!is_qgc && pair.size() != 2) return std::nullopt;
  const std::optional<double> value = to_number(geometry::trimmed(is_qgc ? tabbed[3] : pair[1]));
  if (!value) return std::nullopt;
  return Parameter{std::string(geometry::trimmed(is_qgc ? tabbed[2] : pair[0])), *value};
}

const Parameter* find(const std::vector<Parameter>& parameters, const std::string& name) {
  const auto found = std::ranges::find(parameters, name, &Parameter::name);
  return found == parameters.end() ? nullptr : &*found;
}

}  // namespace

std::string parameters_name(AutopilotType autopilot, const std::string& stem) {
  if (autopilot == AutopilotType::dji) return "";
  return stem + (autopilot == AutopilotType::px4 ? ".params" : ".param");
}

std::string write_parameters(const FlightPlan& plan) {
  if (plan.vehicle.autopilot == AutopilotType::dji) {
    throw Error(ErrorKind::bad_config, "vehicle \"" + plan.vehicle.name +
                                           "\" does not use parameter files; use --format kmz");
  }
  return ParameterWriter(plan, plan.verified_returns()).write();
}

std::vector<Parameter> read_parameters(const std::string& text) {
  std::vector<Parameter> parameters;
  std::size_t number = 0;
  for (const std::string& line : split_lines(text)) {
    ++number;
    if (geometry::trimmed(line).empty() || geometry::trimmed(line).starts_with('#')) continue;
    const std::optional<Parameter> parameter = parameter_in(line);
    if (!parameter) {
      throw Error(
          ErrorKind::bad_file,
          "line " + std::to_string(number) + " is \"" + geometry::excerpt(line) +
              "\"; it must be NAME,VALUE or the five tab-separated fields of QGroundControl");
    }
    parameters.push_back(*parameter);
  }
  return parameters;
}

std::optional<double> return_height(const std::vector<Parameter>& parameters,
                                    AutopilotType autopilot) {
  if (autopilot == AutopilotType::px4) {
    const Parameter* height = find(parameters, "RTL_RETURN_ALT");
    return height == nullptr ? std::nullopt : std::optional(height->value);
  }
  const Parameter* metres = find(parameters, "RTL_ALT_M");
  const Parameter* centimetres = find(parameters, "RTL_ALT");
  if (metres != nullptr) return metres->value;
  return centimetres == nullptr ? std::nullopt : std::optional(centimetres->value / 100.0);
}

Problems return_problems(const std::vector<Parameter>& parameters, AutopilotType autopilot) {
  Problems problems;
  for (const Requirement& required : requirements(autopilot)) {
    const Parameter* found = find(parameters, required.name);
    if (found == nullptr && find(parameters, required.other_name) != nullptr) continue;
    const double value = found == nullptr ? required.by_default : found->value;
    if (value >= required.min && value <= required.max) continue;
    problems.push_back(std::string(required.name) + " is " + plain(value) + "; it must be " +
                       (required.min == required.max
                            ? plain(required.max)
                            : "from " + plain(required.min) + " to " + plain(required.max)));
  }
  const Parameter* metres = find(parameters, "RTL_ALT_M");
  const Parameter* centimetres = find(parameters, "RTL_ALT");
  if (metres != nullptr && centimetres != nullptr &&
      std::abs(100.0 * metres->value - centimetres->value) > 0.5) {
    problems.push_back("RTL_ALT is " + plain(centimetres->value) + " cm and RTL_ALT_M " +
                       plain(metres->value) + " m; they must be equal");
  }
  return problems;
}

std::string return_altitude_text(double height) { return plain(height); }

}  // namespace skycap::flight
