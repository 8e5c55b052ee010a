#include "missions/package/pilot_text.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "flight/export/geodesy.h"
#include "flight/export/parameters.h"
#include "missions/package/fleet_mission.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

using flight::AutopilotType;

/// Part of a mission for one vehicle.
struct Part {
  const flight::FlightOptions& options;
  const flight::Route& route;
  const FlightFiles& files;
};

/// Returns the names of the written files with this ending, separated by commas; empty if there are
/// none.
std::string join_names(const FlightFiles& files, std::string_view extension) {
  std::string names;
  for (const FlightFile& file : files.written) {
    if (file.name.ends_with(extension)) names += (names.empty() ? "" : ", ") + file.name;
  }
  return names;
}

std::string parameter_file(const Part& part) {
  const std::string extension = flight::parameters_name(part.route.vehicle.autopilot, "");
  for (const std::string& name : part.files.parameters) {
    if (name.ends_with(extension)) return name;
  }
  return "";
}

std::string takeoff_text(const Part& part) {
  const Eigen::Vector3d& pad = part.route.options.takeoff;
  const std::string local =
      fmt::format("({:.1f}, {:.1f}, {:.1f}) of the mission frame", pad.x(), pad.y(), pad.z());
  if (!part.options.is_georeferenced) return local;
  const flight::GeodeticPoint point = flight::LocalFrame(part.options.site.origin).to_geodetic(pad);
  return fmt::format("latitude {:.7f}, longitude {:.7f}, {}", point.latitude_deg,
                     point.longitude_deg, local);
}

/// Returns the additional items of an upload: geofence and rally points. Empty without them.
std::string plan_extras(const Part& part) {
  const flight::AirspaceOptions& airspace = part.options.airspace;
  const bool has_fence = !airspace.geofence.empty() || !airspace.no_fly.empty();
  if (has_fence && !part.options.rally.empty()) return "the geofence and the rally points";
  if (has_fence) return "the geofence";
  return part.options.rally.empty() ? "" : "the rally points";
}

const char* verified = "verified from every point of the route, at this altitude only";

std::vector<std::string> ardupilot_steps(const Part& part) {
  std::vector<std::string> steps;
  const std::string parameters = parameter_file(part);
  if (!parameters.empty()) {
    const double height = part.route.returns->height;
    steps.push_back("Load " + parameters +
                    " into the autopilot (Mission Planner or QGroundControl: load parameters from "
                    "file). Restart the autopilot if the ground station requests it.");
    steps.push_back(fmt::format(
        "Read back the return altitude: RTL_ALT {:.0f} cm or RTL_ALT_M {} m above take-off ({}), "
        "and RTL_CONE_SLOPE 0.",
        100.0 * height, flight::return_altitude_text(height), verified));
    steps.push_back(
        "Set BATT_CAPACITY, BATT_LOW_MAH and BATT_CRT_MAH according to the comments in " +
        parameters + ".");
  }
  const std::string plan = join_names(part.files, ".plan");
  const std::string waypoints = join_names(part.files, ".waypoints");
  if (const std::string extras = plan_extras(part); !extras.empty() && !plan.empty()) {
    steps.push_back("Upload " + extras + " from " + plan + ".");
  }
  if (!plan.empty() || !waypoints.empty()) {
    steps.push_back("Upload the mission: " + waypoints +
                    (plan.empty() || waypoints.empty() ? "" : " (Mission Planner) or ") + plan +
                    (plan.empty() ? "." : " (QGroundControl)."));
  }
  return steps;
}

std::vector<std::string> px4_steps(const Part& part) {
  std::vector<std::string> steps;
  const std::string parameters = parameter_file(part);
  if (!parameters.empty()) {
    steps.push_back("Load " + parameters +
                    " in QGroundControl (Vehicle Setup, Parameters, Tools, Load from file). "
                    "Restart the autopilot if the ground station requests it.");
    steps.push_back(fmt::format(
        "Read back the return altitude: RTL_RETURN_ALT {} m above take-off ({}), and RTL_CONE_ANG "
        "0.",
        flight::return_altitude_text(part.route.returns->height), verified));
    steps.push_back(fmt::format(
        "Before the first flight near obstacles, fly a test mission in free space. Check that the "
        "logged track stays within {} m of the legs (flight.tracking_error); in a simulator, PX4 "
        "left them by up to 3 m.",
        support::short_text(part.route.options.clearance.tracking_error)));
  }
  const std::string plan = join_names(part.files, ".plan");
  const std::string extras = plan_extras(part);
  if (!plan.empty()) {
    steps.push_back("Upload " + plan + " in QGroundControl (Plan view)" +
                    (extras.empty() ? "." : ": the mission, " + extras + "."));
  } else if (const std::string waypoints = join_names(part.files, ".waypoints");
             !waypoints.empty()) {
    steps.push_back("Upload the mission: " + waypoints + ".");
  }
  return steps;
}

/// Returns the step that loads the route into the vehicle's app. Empty without a file for it.
std::string load_step(const Part& part) {
  const std::string kmz = join_names(part.files, ".kmz");
  const std::string litchi = join_names(part.files, ".litchi.csv");
  switch (part.route.vehicle.app) {
    case flight::MissionApp::litchi:
      return litchi.empty()
                 ? ""
                 : "Import " + litchi +
                       " in Litchi Mission Hub, one mission per file. Set heading mode "
                       "\"Custom\", path mode \"Straight Lines\" and finish action \"RTH\".";
    case flight::MissionApp::fly:
      return kmz.empty() ? ""
                         : "Create a waypoint flight in DJI Fly for each file and replace its .kmz "
                           "file in the folder \"waypoint\" of the controller by " +
                               kmz + ". Open the flight and compare its waypoints with the report.";
    default:
      return kmz.empty()
                 ? ""
                 : "Import " + kmz + " in DJI Pilot 2 as a flight route, or in FlightHub 2.";
  }
}

std::vector<std::string> dji_steps(const Part& part) {
  std::vector<std::string> steps;
  if (const std::string load = load_step(part); !load.empty()) steps.push_back(load);
  if (part.route.returns) {
    steps.push_back(fmt::format(
        "Set the RTH altitude to {} m in {} ({}). The value in the file does not replace "
        "this setting.",
        flight::return_altitude_text(part.route.returns->height), to_string(part.route.vehicle.app),
        verified));
    steps.push_back(
        "Set the RTH mode to \"preset\" and the action on signal loss to return to home. The path "
        "of the RTH mode \"optimal\" is not verified.");
  }
  return steps;
}

std::vector<std::string> pilot_steps(const Part& part) {
  std::vector<std::string> steps;
  switch (part.route.vehicle.autopilot) {
    case AutopilotType::ardupilot:
      steps = ardupilot_steps(part);
      break;
    case AutopilotType::px4:
      steps = px4_steps(part);
      break;
    case AutopilotType::dji:
      steps = dji_steps(part);
      break;
  }
  steps.push_back("Take off at " + takeoff_text(part) + ".");
  if (part.route.vehicle.autopilot == AutopilotType::dji) {
    steps.back() += " Check that the home point is at this position.";
  } else {
    steps.back() +=
        " After arming, check that the home position is within 2 m of this point; returns end at "
        "home.";
  }
  return steps;
}

/// The parts of a mission that have a route, with what to call them.
std::vector<std::pair<std::string, Part>> make_parts(const flight::FlightOptions& options,
                                                     const SurveyMission& flight) {
  if (!flight.fleet) {
    return {{flight.route.vehicle.name, {options, flight.route, flight.files}}};
  }
  std::vector<std::pair<std::string, Part>> parts;
  for (std::size_t v = 0; v < flight.fleet->members.size(); ++v) {
    const FleetMember& member = flight.fleet->members[v];
    if (member.route.sorties.empty()) continue;
    parts.push_back({fmt::format("vehicle {} ({})", v + 1, member.route.vehicle.name),
                     {member.flight, member.route, member.files}});
  }
  return parts;
}

using Warnings = std::vector<std::string>;

/// Warns about pads with unknown slope.
void add_slope(const flight::Route& route, const std::string& whose, Warnings& warnings) {
  const std::size_t rally = route.options.returns ? route.options.returns->rally.size() : 0;
  const std::size_t known = route.options.landing_surfaces.size();
  if (known > rally) return;
  std::string what = "the take-off pad" + whose + " is";
  if (rally > 0) {
    what = fmt::format("{} of {} landing points{} (take-off point, rally points) is",
                       1 + rally - known, 1 + rally, whose);
  }
  warnings.push_back("slope of " + what + " unknown. Inspect the pad and set flight.pad_slope_deg");
}

/// Warns if the flight time is a range, with its maximum.
void add_time(const flight::Route& route, const std::string& whose, Warnings& warnings) {
  const double longest = route.options.conditions.longest_flight;
  if (longest == 1.0 || route.sorties.empty()) return;
  warnings.push_back(fmt::format(
      "flight time{} {:.1f} to {:.1f} min: PX4 took up to {:.1f} times the estimated time in its "
      "simulator; {} planned for the longer time, one battery each",
      whose, route.duration / 60.0, longest * route.duration / 60.0, longest,
      support::counted(route.sorties.size(), "sortie")));
}

/// Views that the files lack, and what can be done.
void add_skipped(const std::vector<flight::Unreached>& unreached, const std::string& whose,
                 Warnings& warnings) {
  for (const flight::Unreached& missed : unreached) {
    warnings.push_back(fmt::format("view {} is not in the route files{}: {}",
                                   missed.capture_point.view_index, whose, missed.reason));
  }
}

void add_images(const SurveyMission& flight, Warnings& warnings) {
  if (!flight.image_motion || flight.image_motion->is_sharp()) return;
  warnings.push_back(fmt::format(
      "image motion of more than one pixel at {:.1f} m. Shorten sensor.exposure or sensor.readout, "
      "or raise the view distance",
      flight.image_motion->distance));
}

bool has_route(const SurveyMission& flight) {
  return flight.failure.empty() && !flight.route.sorties.empty();
}

}  // namespace

std::vector<PilotSteps> pilot_steps(const flight::FlightOptions& options,
                                    const SurveyMission& flight) {
  std::vector<PilotSteps> all;
  if (!has_route(flight)) return all;
  for (const auto& [whom, part] : make_parts(options, flight)) {
    all.push_back({whom, pilot_steps(part)});
  }
  return all;
}

std::string unverified_text(const flight::FlightOptions& options, const SurveyMission& flight) {
  std::string text = "moving obstacles, landings other than at the take-off point";
  const bool has_rally =
      flight.route.options.returns && !flight.route.options.returns->rally.empty();
  if (has_rally) text += " and the rally points";
  if (!options.airspace.geofence.empty()) text += ", returns from outside the geofence";
  text += fmt::format(", the climb to {:.1f} m above take-off", flight.route.options.takeoff_climb);
  if (has_rally) text += ", the airspace above the rally points";
  return text + ", unobserved airspace outside flight.unknown_box";
}

std::vector<std::string> pilot_warnings(const SurveyMission& flight) {
  Warnings warnings;
  add_skipped(flight.route.unreached, "", warnings);
  if (!flight.fleet) {
    add_slope(flight.route, "", warnings);
    add_time(flight.route, "", warnings);
  } else {
    for (std::size_t v = 0; v < flight.fleet->members.size(); ++v) {
      const FleetMember& member = flight.fleet->members[v];
      if (member.route.sorties.empty()) continue;
      const std::string whose = fmt::format(" of vehicle {}", v + 1);
      add_slope(member.route, whose, warnings);
      add_time(member.route, whose, warnings);
    }
    add_skipped(flight.fleet->unreached, " of the fleet", warnings);
  }
  add_images(flight, warnings);
  return warnings;
}

std::string pilot_text(const flight::FlightOptions& options, const SurveyMission& flight,
                       const std::vector<std::string>& more) {
  std::string text;
  for (const PilotSteps& part : pilot_steps(options, flight)) {
    text += "Before the flight (" + part.whom + "):\n";
    for (std::size_t i = 0; i < part.steps.size(); ++i) {
      text += fmt::format("  {}. {}\n", i + 1, part.steps[i]);
    }
  }
  Warnings warnings = more;
  if (has_route(flight)) {
    if (flight.fleet) {
      text += "To do, all vehicles: start each sortie at its time in timetable.csv.\n";
    }
    text += "Not verified; the pilot must check: " + unverified_text(options, flight) + ".\n";
    for (const std::string& warning : pilot_warnings(flight)) warnings.push_back(warning);
  }
  for (const std::string& warning : warnings) text += "Warning: " + warning + ".\n";
  return text;
}

}  // namespace skycap::missions::package
