#include "flight/export/scanner_commands.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "flight/motion/motion.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Changes heading and gimbal pitch so that the camera axis coincides with the scanner's optical
/// axis.
void aim_at(FlightPlan& plan, const ScannerAim& aim) {
  for (Waypoint& waypoint : plan.waypoints) {
    if (!waypoint.is_capture_point) continue;
    waypoint.yaw -= aim.azimuth;  // Headings are clockwise, azimuths counter-clockwise.
    waypoint.pitch = aim.pitch;
    waypoint.captures = 0;
  }
}

/// Returns the turning point of a calibration from `end` towards `other`, or nullopt if the leg is
/// too short or too steep for the acceleration.
std::optional<Vector3d> turning_point(const Vector3d& end, const Vector3d& other) {
  constexpr double max_slope = 0.5;  // Sine of the slope.
  const Vector3d leg = other - end;
  const double length = leg.norm();
  if (length < min_calibration_length || std::abs(leg.z()) > max_slope * length)
    return std::nullopt;
  return end + std::min(1.0, calibration_length / length) * leg;
}

/// Returns the waypoints from `end` to the turning point and back, repeated for all calibration
/// flights.
std::vector<Waypoint> calibration(const Waypoint& end, const Vector3d& turning,
                                  const Waypoint& neighbour) {
  std::vector<Waypoint> waypoints;
  for (int i = 0; i < calibration_turns; ++i) {
    for (const Vector3d& position : {turning, end.position}) {
      Waypoint waypoint;
      waypoint.position = position;
      waypoint.hold = corner_hold;
      waypoint.clearance = neighbour.clearance;
      waypoints.push_back(waypoint);
    }
  }
  return waypoints;
}

/// Returns the energy of both calibrations [J].
double calibration_energy(const FlightPlan& plan, const Vector3d& begin, const Vector3d& end) {
  const Motion motion(plan.vehicle, plan.conditions);
  double energy = 0.0;
  for (const Vector3d& leg : {begin, Vector3d(-begin), end, Vector3d(-end)}) {
    energy += calibration_turns *
              (motion.leg_energy(leg, motion.leg_time(leg)) + motion.hover_energy(corner_hold));
  }
  return energy;
}

void calibrate(FlightPlan& plan, double energy_left, std::vector<std::string>& notes) {
  std::vector<Waypoint>& waypoints = plan.waypoints;
  const std::string name = commanded_scanner(plan.vehicle.wpml.payload);
  const auto by_hand = [&](const std::string& reason) {
    notes.push_back(plan.name + ": calibrate the IMU of the " + name +
                    " by hand before and after the route; " + reason);
  };
  const std::size_t last = waypoints.size() - 1;
  const auto begin = turning_point(waypoints[0].position, waypoints[1].position);
  const auto end = turning_point(waypoints[last].position, waypoints[last - 1].position);
  if (!begin || !end) {
    by_hand("the first or last leg is shorter than 10 m or steeper than 30 degrees");
    return;
  }
  const Vector3d out = *begin - waypoints[0].position, back = *end - waypoints[last].position;
  if (calibration_energy(plan, out, back) > energy_left) {
    by_hand("the energy above the battery reserve is not sufficient for calibration flights");
    return;
  }
  const std::vector<Waypoint> after = calibration(waypoints[last], *end, waypoints[last]);
  waypoints.insert(waypoints.end(), after.begin(), after.end());
  std::vector<Waypoint> before{waypoints[0]};
  const std::vector<Waypoint> turns = calibration(waypoints[0], *begin, waypoints[1]);
  before.insert(before.end(), turns.begin(), turns.end() - 1);
  waypoints.insert(waypoints.begin(), before.begin(), before.end());
}

}  // namespace

std::string commanded_scanner(int payload) {
  if (payload == zenmuse_l1) return "Zenmuse L1";
  return payload == zenmuse_l2 ? "Zenmuse L2" : "";
}

FlightPlan with_scanner_commands(FlightPlan plan, Format format, const ScannerAim& aim,
                                 double energy_left, std::vector<std::string>& notes) {
  if (!captures_images(format)) return plan;  // The format commands no sensor.
  const std::string extension = format_info(format).extension;
  const std::string name = commanded_scanner(plan.vehicle.wpml.payload);
  if (name.empty()) {
    notes.push_back("start the scanner recording before take-off: " + extension +
                    " files cannot control the scanner");
    return plan;
  }
  if (format != Format::kmz || !aim.is_moving) {
    throw Error(ErrorKind::bad_config,
                extension + " files cannot control the " + name +
                    (format == Format::kmz ? " at stops; set sensor.capture: moving"
                                           : "; export kmz for a DJI vehicle"));
  }
  aim_at(plan, aim);
  calibrate(plan, energy_left, notes);
  return plan;
}

RecordedWaypoints recorded_waypoints(const FlightPlan& plan) {
  const std::vector<Waypoint>& waypoints = plan.waypoints;
  const auto is_capture_point = [](const Waypoint& waypoint) { return waypoint.is_capture_point; };
  const auto first_station = std::ranges::find_if(waypoints, is_capture_point) - waypoints.begin();
  const auto last_capture_point =
      std::find_if(waypoints.rbegin(), waypoints.rend(), is_capture_point).base() -
      waypoints.begin();
  RecordedWaypoints range{0, waypoints.size() - 1};
  for (auto i = static_cast<std::size_t>(first_station); i-- > 0;) {
    range.first = i;
    if (waypoints[i].position == waypoints.front().position) break;
  }
  for (auto i = static_cast<std::size_t>(last_capture_point); i < waypoints.size(); ++i) {
    range.last = i;
    if (waypoints[i].position == waypoints.back().position) break;
  }
  return range;
}

}  // namespace skycap::flight
