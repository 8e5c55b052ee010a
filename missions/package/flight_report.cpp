#include "missions/package/flight_report.h"

#include <fmt/format.h>

#include "flight/route/route.h"

namespace skycap::missions::package {
std::string flight_text(const SurveyMission& flight) {
  if (!flight.failure.empty()) return "  flight    no route: " + flight.failure + "\n";
  const flight::Route& route = flight.route;
  const flight::ClearanceBudget& clearance = route.options.clearance;
  std::string text =
      fmt::format("  flight    {}, {} views, {:.1f} m in {:.1f} min, {} {}", route.vehicle.name,
                  route.stations.size(), route.length, route.duration / 60.0, route.sorties.size(),
                  route.sorties.size() == 1 ? "sortie" : "sorties");
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
  for (const flight::Unreached& missed : route.unreached) {
    text += fmt::format("  left out  view {}: {}\n", missed.station.view_index, missed.reason);
  }
  std::string files;
  for (const FlightFile& file : flight.files.written) files += " " + file.name;
  if (!files.empty()) text += "  files    " + files + "\n";
  for (const std::string& note : flight.files.notes) text += "  note      " + note + "\n";
  return text;
}

}  // namespace skycap::missions::package
