#include "missions/package/flight_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "flight/export/parameters.h"
#include "flight/motion/flight_time_range.h"
#include "flight/route/route.h"
#include "missions/package/anew_mission.h"
#include "missions/package/fleet_report.h"
#include "missions/package/ground_json.h"
#include "missions/session/way_frames.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

std::string return_text(const SurveyMission& flight) {
  if (!flight.route.returns) return "";
  const flight::Returns& returns = *flight.route.returns;
  std::string text = fmt::format("  return    certified at {} m above the pad, least {:.2f} m",
                                 flight::return_altitude_text(returns.height), returns.clearance);
  if (!returns.obstacle.empty()) text += " from " + returns.obstacle;
  const std::vector<std::string>& files = flight.files.parameters;
  for (std::size_t i = 0; i < files.size(); ++i) text += (i == 0 ? "; set by " : ", ") + files[i];
  return text + "\n";
}

/// What is flown past its views, by files that can say so.
std::string passage_text(const flight::Route& route) {
  if (route.options.style != flight::FlightStyle::pass) return "";
  std::size_t views = 0, stops = 0;
  double length = 0.0;
  for (const flight::Sortie& sortie : route.sorties) {
    if (!sortie.passage) continue;
    views += sortie.passage->views.size(), stops += sortie.passage->stops;
    length += sortie.passage->length + 2.0 * route.options.takeoff_climb;
  }
  const double speed = std::min(route.options.passing.speed, route.options.conditions.cruise_speed);
  if (views == 0) {
    return fmt::format(
        "  passing   nothing: stopping is no slower than passing at {:.1f} m/s, at which pictures "
        "are sharp; shorten sensor.exposure\n",
        speed);
  }
  return fmt::format(
      "  passing   {} views at up to {:.1f} m/s, {} stops, {:.1f} m in {:.1f} min, by the "
      "trajectory and KML files\n",
      views, speed, stops, length, flight::least_duration(route) / 60.0);
}

/// Minutes that are a range, with its upper end.
std::string time_range_text(const flight::Route& route) {
  const double longest = route.options.conditions.longest_flight;
  if (longest == 1.0 || route.sorties.empty()) return "";
  return fmt::format(
      "  Warning: {:.1f} to {:.1f} min: PX4 took up to {:.1f} times as long as predicted in its "
      "simulator; {} hold the longer time, one battery each\n",
      route.duration / 60.0, longest * route.duration / 60.0, longest,
      support::counted(route.sorties.size(), "sortie"));
}

std::string pictures_text(const SurveyMission& flight) {
  if (!flight.pictures) return "";
  const auto& [blur, shear, distance] = *flight.pictures;
  std::string text = fmt::format("  pictures  blurred by at most {:.2f} px", blur);
  if (shear > 0.0) text += fmt::format(", sheared by {:.2f} px", shear);
  text += fmt::format(", at {:.1f} m", distance);
  if (!flight.pictures->is_sharp()) {
    text += ": more than a pixel; shorten sensor.exposure or sensor.readout, or look from farther";
  }
  return text + "\n";
}

}  // namespace

std::string flown_text(const flight::FlightOptions& options, const session::SurveyRecord& record) {
  const session::FlownSurvey& flown = record.flown.value();
  std::string text =
      fmt::format("  survey    {:.1f} m in {:.1f} min, from the pad to the last view",
                  flown.length(), flown.time() / 60.0);
  if (options.capture.scans_in_flight()) {
    text += fmt::format("; {} scans on the way at {:g} m/s", record.frames_on_way(),
                        options.cruise_speed);
  } else if (options.capture.is_moving) {
    const flight::PictureBounds bounds = session::moving_bounds_of(options);
    text += fmt::format("; {} frames on the way, blurred by at most {:.2f} px",
                        record.frames_on_way(), bounds.blur_px);
    if (bounds.shear_px > 0.0) text += fmt::format(" and sheared by {:.2f} px", bounds.shear_px);
    text += fmt::format(" at {:.1f} m", bounds.distance);
    if (!bounds.is_sharp()) text += ": more than a pixel; shorten sensor.exposure";
    text += "\n            the mission below takes pictures at its views only, and covers less";
  }
  return text + "\n";
}

std::string flight_text(const SurveyMission& flight) {
  if (!flight.failure.empty()) return "  flight    no route: " + flight.failure + "\n";
  const flight::Route& route = flight.route;
  const flight::ClearanceBudget& clearance = route.options.clearance;
  std::string text =
      fmt::format("  flight    {}, {} views, {:.1f} m in {:.1f} min, {}", route.vehicle.name,
                  route.stations.size(), route.length, route.duration / 60.0,
                  support::counted(route.sorties.size(), "sortie"));
  if (route.options.order_is_free && route.order_bound > 0.0) {
    text += fmt::format("; order within {:.1f} % of the shortest",
                        100.0 * (route.order_length / route.order_bound - 1.0));
  }
  text += fmt::format(
      "\n  clearance every leg proven at {:.2f} m, least {:.2f} m (vehicle {:.2f} + position "
      "{:.2f} "
      "+ tracking {:.2f} + map {:.2f} + margin {:.2f})\n",
      clearance.total(), route.min_clearance, clearance.vehicle_radius, clearance.position_error,
      clearance.tracking_error, clearance.map_error, clearance.margin);
  text += passage_text(route);
  if (flight.anew) text += anew_text(*flight.anew);
  if (flight.again) text += "  promise   " + again_text(*flight.again) + "\n";
  const std::size_t rally_points = route.options.returns ? route.options.returns->rally.size() : 0;
  text += grounds_text(route.options.grounds, 1 + rally_points);
  text += return_text(flight);
  text += pictures_text(flight);
  for (const flight::Unreached& missed : route.unreached) {
    text += fmt::format("  left out  view {}: {}\n", missed.station.view_index, missed.reason);
  }
  std::string files;
  for (const FlightFile& file : flight.files.written) {
    files += " " + file.name;
    // Another autopilot than the vehicle's takes another time.
    const double planned = route.sorties[file.sortie].duration;
    if (std::abs(file.duration - planned) < 0.01 * planned) continue;
    files += fmt::format(" ({:.1f} min)", file.duration / 60.0);
  }
  if (!files.empty()) text += "  files    " + files + "\n";
  if (flight.fleet) text += fleet_text(*flight.fleet);
  for (const std::string& note : flight.files.notes) text += "  note      " + note + "\n";
  text += time_range_text(route);
  return text;
}

}  // namespace skycap::missions::package
