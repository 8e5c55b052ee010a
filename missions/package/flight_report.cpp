#include "missions/package/flight_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "flight/export/parameters.h"
#include "flight/route/route.h"
#include "missions/package/fleet_report.h"
#include "missions/package/ground_json.h"
#include "missions/package/replanned_mission.h"
#include "missions/session/en_route_frames.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

std::string return_text(const SurveyMission& flight) {
  if (!flight.route.returns) return "";
  const flight::Returns& returns = *flight.route.returns;
  std::string text =
      fmt::format("  return    altitude {} m above take-off, minimum clearance {:.2f} m",
                  flight::return_altitude_text(returns.height), returns.clearance);
  if (!returns.obstacle.empty()) text += " to " + returns.obstacle;
  return text + "\n";
}

/// Describes a fly-through flight and the files that support it.
std::string fly_through_text(const flight::Route& route) {
  if (route.options.style != flight::FlightStyle::pass) return "";
  std::size_t views = 0, stops = 0;
  double length = 0.0;
  for (const flight::Sortie& sortie : route.sorties) {
    if (!sortie.fly_through) continue;
    views += sortie.fly_through->views.size(), stops += sortie.fly_through->stops;
    length += sortie.fly_through->length + 2.0 * route.options.takeoff_climb;
  }
  const double speed = std::min(route.options.passing.speed, route.options.conditions.cruise_speed);
  if (views == 0) {
    return fmt::format(
        "  passing   none: fly-through at {:.1f} m/s (sharp images) is not faster than "
        "stopping; shorten sensor.exposure\n",
        speed);
  }
  return fmt::format(
      "  passing   {} views at up to {:.1f} m/s, {} stops, {:.1f} m in {:.1f} min, in the "
      "trajectory and KML files only\n",
      views, speed, stops, length, flight::min_duration(route) / 60.0);
}

std::string image_motion_text(const SurveyMission& flight) {
  if (!flight.image_motion) return "";
  const auto& [blur, shear, distance] = *flight.image_motion;
  std::string text = fmt::format("  images    motion blur up to {:.2f} px", blur);
  if (shear > 0.0) text += fmt::format(", rolling-shutter skew up to {:.2f} px", shear);
  return text + fmt::format(" at {:.1f} m\n", distance);
}

/// Returns the limit of the vehicle's app, which divides the mission into sorties.
std::string waypoint_limit_text(const flight::Route& route) {
  if (!route.vehicle.needs_waypoint_per_photo() || route.sorties.empty()) return "";
  std::string counts;
  for (const flight::Sortie& sortie : route.sorties) {
    counts += (counts.empty() ? "" : ", ") + std::to_string(sortie_points(route, sortie).size());
  }
  return fmt::format(
      "  waypoints {} of at most {} per file ({}), one per photo; each sortie has its own "
      "take-off, "
      "verified returns and landing\n",
      counts, route.vehicle.max_waypoints, to_string(route.vehicle.app));
}

}  // namespace

std::string survey_flight_text(const flight::FlightOptions& options,
                               const session::SurveyRecord& record) {
  const session::FlightRecord& flight_record = record.flight_record.value();
  std::string text =
      fmt::format("  survey    {:.1f} m in {:.1f} min, from take-off to the last view",
                  flight_record.length(), flight_record.time() / 60.0);
  if (options.capture.scans_in_flight()) {
    text += fmt::format("; {} en-route scans at {:g} m/s", record.en_route_frames(),
                        options.cruise_speed);
  } else if (options.capture.is_moving) {
    const flight::ImageMotionBounds bounds = session::compute_motion_bounds(options);
    text += fmt::format("; {} en-route frames, motion blur up to {:.2f} px",
                        record.en_route_frames(), bounds.blur_px);
    if (bounds.shear_px > 0.0)
      text += fmt::format(", rolling-shutter skew up to {:.2f} px", bounds.shear_px);
    text += fmt::format(" at {:.1f} m", bounds.distance);
    if (!bounds.is_sharp()) text += ": more than one pixel; shorten sensor.exposure";
    text +=
        "\n"
        "            the exported mission captures at its views only and covers less";
  }
  return text + "\n";
}

std::string flight_text(const SurveyMission& flight, bool is_verbose) {
  if (!flight.failure.empty()) return "  flight    none: " + flight.failure + "\n";
  const flight::Route& route = flight.route;
  const flight::ClearanceBudget& clearance = route.options.clearance;
  const bool is_passing =
      std::ranges::any_of(route.capture_points, &flight::CapturePoint::is_passed);
  std::string text =
      fmt::format("  flight    {}, {} {}, {:.1f} m in {:.1f} min, {}", route.vehicle.name,
                  route.capture_points.size(), is_passing ? "waypoints" : "views", route.length,
                  route.duration / 60.0, support::counted(route.sorties.size(), "sortie"));
  if (is_verbose && route.options.order_is_free && route.order_bound > 0.0) {
    text += fmt::format("; tour at most {:.1f}% longer than the shortest",
                        100.0 * (route.order_length / route.order_bound - 1.0));
  }
  text += fmt::format(
      "\n  clearance minimum {:.2f} m, verified for every leg; required {:.2f} m (vehicle {:.2f} + "
      "position {:.2f} + tracking {:.2f} + map {:.2f} + margin {:.2f})\n",
      route.min_clearance, clearance.total(), clearance.vehicle_radius, clearance.position_error,
      clearance.tracking_error, clearance.map_error, clearance.margin);
  text += waypoint_limit_text(route);
  text += fly_through_text(route);
  if (flight.replanned) text += replanned_text(*flight.replanned);
  text += landing_surfaces_text(route.options.landing_surfaces);
  text += return_text(flight);
  text += image_motion_text(flight);
  std::string files;
  for (const FlightFile& file : flight.files.written) {
    files += " " + file.name;
    // Durations differ if the file is for another autopilot than the vehicle's.
    const double planned = route.sorties[file.sortie].duration;
    if (std::abs(file.duration - planned) < 0.01 * planned) continue;
    files += fmt::format(" ({:.1f} min)", file.duration / 60.0);
  }
  if (!files.empty()) text += "  files    " + files + "\n";
  if (flight.fleet) text += fleet_text(*flight.fleet, is_verbose);
  for (const std::string& note : flight.files.notes) text += "  note      " + note + "\n";
  return text;
}

}  // namespace skycap::missions::package
