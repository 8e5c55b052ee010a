#include "missions/package/field_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "flight/export/geodesy.h"
#include "flight/export/parameters.h"
#include "missions/package/fleet_mission.h"
#include "missions/package/holes.h"
#include "missions/package/pilot_text.h"
#include "missions/package/written_mission.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Maximum number of entries on the page next to the map. Further entries are only counted.
constexpr std::size_t max_sorties = 8, max_holes = 5, max_warnings = 3, max_dots = 2500;

constexpr double map_width = 186.0, map_height = 80.0;  ///< [mm]

constexpr std::array sortie_colours{"#0b5fa5", "#b3500a", "#1d7a3a", "#8a1f7a",
                                    "#a80f2c", "#4a4a8c", "#6b6b00", "#007a7a"};

constexpr const char* style = R"(@page { size: A4; margin: 10mm 12mm; }
* { box-sizing: border-box; }
body { font: 8pt/1.22 Arial, Helvetica, sans-serif; color: #000; margin: 0 auto; width: 186mm; }
h1 { font-size: 13pt; margin: 0 0 1mm; } h2 { font-size: 9.4pt; margin: 2mm 0 0.6mm; border-bottom: 0.3mm solid #000; }
.top { display: flex; justify-content: space-between; align-items: baseline; }
.fill { font-size: 8.6pt; } .fill span { display: inline-block; border-bottom: 0.2mm solid #000; width: 30mm; }
svg { display: block; width: 186mm; height: 80mm; border: 0.3mm solid #000; }
.figures { display: grid; grid-template-columns: repeat(4, 1fr); gap: 1mm; margin: 1.5mm 0; }
.figures div { border: 0.3mm solid #000; padding: 0.8mm 1.4mm; } .figures b { display: block; font-size: 12pt; }
.columns { display: grid; grid-template-columns: 1fr 1fr; gap: 0 5mm; }
ol, ul { margin: 0; padding-left: 4.5mm; } li { margin: 0.3mm 0; } ul.check { list-style: none; padding-left: 0; }
ul.check li::before { content: "\2610  "; } p { margin: 0.4mm 0; }
table { border-collapse: collapse; width: 100%; } td, th { border: 0.2mm solid #555; padding: 0.3mm 1mm; text-align: right; font-weight: normal; }
th { background: #eee; } td:first-child, th:first-child { text-align: left; }
.foot { font-size: 7pt; margin-top: 1.5mm; }
@media screen { body { padding: 8mm; width: 202mm; } })";

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string percent_text(double share) { return fmt::format("{:.1f} %", 100.0 * share); }

/// Route of the single vehicle or of one vehicle of the fleet.
struct VehicleRoute {
  const flight::Route* route;
  const FlightFiles* files;
};

std::vector<VehicleRoute> list_routes(const SurveyMission& mission) {
  if (!mission.fleet) return {{&mission.route, &mission.files}};
  std::vector<VehicleRoute> all;
  for (const FleetMember& member : mission.fleet->members) {
    if (!member.route.sorties.empty()) all.push_back({&member.route, &member.files});
  }
  return all;
}

/// Map with north up, all routes and the surface to be surveyed.
class Map {
 public:
  Map(const FieldSheetSite& site, const flight::FlightOptions& options,
      const SurveyMission& mission)
      : site_(site), options_(options), mission_(mission) {
    for (const VehicleRoute& vehicle_route : list_routes(mission)) {
      box_.extend(Vector2d(vehicle_route.route->options.takeoff.head<2>()));
      for (const flight::Sortie& sortie : vehicle_route.route->sorties) {
        for (const Vector3d& point : sortie_points(*vehicle_route.route, sortie)) {
          box_.extend(Vector2d(point.head<2>()));
        }
      }
    }
    for (const Eigen::Vector3f& position : site.surface) {
      box_.extend(Vector2d(position.head<2>().cast<double>()));
    }
    for (const Vector3d& position : options.rally) box_.extend(Vector2d(position.head<2>()));
    for (const Vector2d& corner : options.airspace.geofence) box_.extend(corner);
    const Vector2d size = box_.sizes().cwiseMax(1.0);
    constexpr double border = 7.0;
    scale_ =
        std::min((map_width - 2.0 * border) / size.x(), (map_height - 2.0 * border) / size.y());
  }

  std::string svg() {
    svg_ = fmt::format("<svg viewBox=\"0 0 {} {}\" font-family=\"Arial\" font-size=\"3\">\n",
                       map_width, map_height);
    for (const geometry::Prism& prism : options_.airspace.no_fly) {
      add_area(prism.footprint, "fill=\"#f6c6c6\" stroke=\"#a80f2c\"", "no-fly " + prism.name);
    }
    if (!options_.airspace.geofence.empty()) {
      add_area(options_.airspace.geofence,
               "fill=\"none\" stroke=\"#000\" stroke-dasharray=\"2 1.2\"", "geofence");
    }
    add_surface();
    std::size_t colour = 0;
    for (const VehicleRoute& vehicle_route : list_routes(mission_)) {
      for (const flight::Sortie& sortie : vehicle_route.route->sorties) {
        add_sortie(*vehicle_route.route, sortie, sortie_colours[colour++ % sortie_colours.size()]);
      }
      add_mark(vehicle_route.route->options.takeoff, "take-off");
    }
    for (std::size_t i = 0; i < options_.rally.size(); ++i) {
      add_mark(options_.rally[i], fmt::format("rally {}", i + 1));
    }
    add_scale();
    return svg_ + "</svg>\n";
  }

 private:
  Vector2d on_map(const Vector2d& position) const {
    const Vector2d from_middle = scale_ * (position - box_.center());
    return {0.5 * map_width + from_middle.x(), 0.5 * map_height - from_middle.y()};
  }

  std::string points(const std::vector<Vector2d>& positions) const {
    std::string text;
    for (const Vector2d& position : positions) {
      const Vector2d point = on_map(position);
      text += fmt::format("{:.2f},{:.2f} ", point.x(), point.y());
    }
    return text;
  }

  void add_area(const std::vector<Vector2d>& corners, const std::string& observation,
                const std::string& name) {
    svg_ +=
        "<polygon points=\"" + points(corners) + "\" stroke-width=\"0.35\" " + observation + "/>\n";
    Vector2d corner = on_map(corners.front());
    for (const Vector2d& other : corners) {
      const Vector2d point = on_map(other);
      if (point.x() + point.y() < corner.x() + corner.y()) corner = point;
    }
    add_text(corner + Vector2d(1.0, 3.4), name);
  }

  void add_text(const Vector2d& point, const std::string& text) {
    svg_ += fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n", point.x(), point.y(),
                        escaped(text));
  }

  /// Draws an even subset of the positions: dark if covered, red if uncovered.
  void add_surface() {
    const std::size_t step = site_.surface.size() / max_dots + 1;
    for (const bool is_covered : {true, false}) {
      std::string path;
      for (std::size_t i = 0; i < site_.surface.size(); i += step) {
        const bool is_marked = site_.is_covered.empty() || site_.is_covered[i] != 0;
        if (is_marked != is_covered) continue;
        const Vector2d point = on_map(site_.surface[i].head<2>().cast<double>());
        path += fmt::format("M{:.2f} {:.2f}h0", point.x(), point.y());
      }
      if (path.empty()) continue;
      svg_ += fmt::format(
          "<path d=\"{}\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\"/>\n", path,
          is_covered ? "#9a9a9a" : "#d7141a", is_covered ? "0.5" : "0.8");
    }
  }

  void add_sortie(const flight::Route& route, const flight::Sortie& sortie, const char* colour) {
    std::vector<Vector2d> line;
    for (const Vector3d& point : sortie_points(route, sortie)) line.emplace_back(point.head<2>());
    svg_ += fmt::format(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" "
        "stroke-width=\"0.4\"/>\n",
        points(line), colour);
    for (std::uint32_t i = sortie.first; i <= sortie.last; ++i) {
      const geometry::View& view = route.capture_points[i].view;
      const Vector2d point = on_map(view.position.head<2>());
      constexpr double arrow = 2.6;
      const Vector2d tip = point + arrow * Vector2d(view.direction.x(), -view.direction.y());
      svg_ += fmt::format(
          "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\" stroke=\"{}\" stroke-width=\"0.5\"/><circle "
          "cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"0.8\" fill=\"{}\"/>\n",
          point.x(), point.y(), tip.x(), tip.y(), colour, point.x(), point.y(), colour);
    }
  }

  void add_mark(const Vector3d& position, const std::string& name) {
    const Vector2d point = on_map(position.head<2>());
    svg_ += fmt::format(
        "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"1.8\" fill=\"#fff\" stroke=\"#000\" "
        "stroke-width=\"0.5\"/><path d=\"M{:.2f} {:.2f}h2M{:.2f} {:.2f}v2\" stroke=\"#000\" "
        "stroke-width=\"0.5\"/>\n",
        point.x(), point.y(), point.x() - 1.0, point.y(), point.x(), point.y() - 1.0);
    add_text(point + Vector2d(2.4, 1.0), name);
  }

  /// Draws a scale bar of a round length and a north arrow.
  void add_scale() {
    constexpr double longest = 40.0;
    double length = 1.0;
    for (const double wider : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0}) {
      if (wider * scale_ <= longest) length = wider;
    }
    svg_ += fmt::format(
        "<path d=\"M3 {0}v2h{1:.2f}v-2\" fill=\"none\" stroke=\"#000\" stroke-width=\"0.4\"/><path "
        "d=\"M{2} 11v-7l-1.6 3.4M{2} 4l1.6 3.4\" fill=\"none\" stroke=\"#000\" "
        "stroke-width=\"0.5\"/>\n",
        map_height - 5.0, length * scale_, map_width - 5.0);
    add_text({4.0, map_height - 4.0}, fmt::format("{:g} m", length));
    add_text({map_width - 6.0, 14.5}, "N");
  }

  const FieldSheetSite& site_;
  const flight::FlightOptions& options_;
  const SurveyMission& mission_;
  AlignedBox2d box_;
  double scale_ = 1.0;  ///< [mm/m]
  std::string svg_;
};

std::string figure(const std::string& value, const std::string& name) {
  return "<div><b>" + escaped(value) + "</b>" + escaped(name) + "</div>\n";
}

/// Returns text such as "6 sorties" or "2 vehicles, 6 sorties".
std::string batteries_text(const std::vector<VehicleRoute>& all) {
  std::size_t sorties = 0;
  for (const VehicleRoute& vehicle_route : all) sorties += vehicle_route.route->sorties.size();
  return support::counted(sorties, "sortie") + ", one battery each" +
         (all.size() > 1 ? fmt::format(", {} vehicles", all.size()) : "");
}

std::string figures(const FieldSheetSite& site, const SurveyMission& mission) {
  const std::vector<VehicleRoute> all = list_routes(mission);
  double minutes = 0.0, longest = 1.0;
  std::size_t sorties = 0, views = 0;
  std::string altitudes;
  for (const VehicleRoute& vehicle_route : all) {
    minutes += vehicle_route.route->duration / 60.0;
    longest = std::max(longest, vehicle_route.route->options.conditions.longest_flight);
    sorties += vehicle_route.route->sorties.size();
    views += vehicle_route.route->capture_points.size();
    if (!vehicle_route.route->returns) continue;
    altitudes += (altitudes.empty() ? "" : " / ") +
                 flight::return_altitude_text(vehicle_route.route->returns->height) + " m";
  }
  const std::string time = longest == 1.0
                               ? fmt::format("{:.0f} min", minutes)
                               : fmt::format("{:.0f} to {:.0f} min", minutes, longest * minutes);
  std::string coverage = percent_text(site.survey_coverage), of = site.coverage_of;
  if (mission.written) {
    const WrittenCoverage& part = mission.written->parts.front();
    coverage = percent_text(part.again.visible.value_or(part.again.all));
    of = fmt::format("of the {}surface covered by the route files ({} of {} views)",
                     part.again.visible ? "visible " : "", part.views, mission.written->planned);
  }
  return "<div class=\"figures\">" +
         figure(altitudes.empty() ? "none" : altitudes, "return altitude above take-off") +
         figure(time, support::counted(views, "view") + ", flight time without battery changes") +
         figure(std::to_string(sorties), batteries_text(all)) + figure(coverage, of) + "</div>\n";
}

std::string list(const char* tag, const char* observation, const std::vector<std::string>& items) {
  std::string html = fmt::format("<{}{}>", tag, observation);
  for (const std::string& item : items) html += "<li>" + escaped(item) + "</li>\n";
  return html + fmt::format("</{}>\n", tag);
}

std::string files_text(const FlightFiles& files, std::size_t sortie) {
  std::string names;
  for (const FlightFile& file : files.written) {
    if (file.sortie == sortie) names += (names.empty() ? "" : ", ") + file.name;
  }
  return names;
}

std::string sorties_table(const SurveyMission& mission) {
  std::string html =
      "<table><tr><th>Sortie, files</th><th>Views</th><th>min</th><th>m</th><th>Wh</th><th>Wh left"
      "</th><th>battery</th></tr>\n";
  std::size_t number = 0, all = 0;
  for (const VehicleRoute& vehicle_route : list_routes(mission)) {
    all += vehicle_route.route->sorties.size();
    for (std::size_t i = 0; i < vehicle_route.route->sorties.size() && number < max_sorties; ++i) {
      const flight::Sortie& sortie = vehicle_route.route->sorties[i];
      constexpr double joules = 3600.0;
      html += fmt::format(
          "<tr><td>{}: {}</td><td>{}</td><td>{:.1f}</td><td>{:.0f}</td><td>{:.0f}</td><td>{:.0f}"
          "</td><td>&emsp;&emsp;</td></tr>\n",
          ++number, escaped(files_text(*vehicle_route.files, i)), sortie.last - sortie.first + 1,
          sortie.duration / 60.0, sortie.length, sortie.energy / joules,
          sortie.energy_left / joules);
    }
  }
  html += "</table>\n";
  if (all > number) html += fmt::format("<p>{} more: see summary.json</p>\n", all - number);
  return html;
}

std::vector<std::string> checks(const flight::FlightOptions& options, const SurveyMission& mission,
                                const FieldSheetSite& site) {
  const flight::Vehicle& vehicle = mission.route.vehicle;
  std::vector<std::string> items;
  std::string wind = fmt::format("Wind at most {:g} m/s", vehicle.max_wind);
  if (options.wind_speed > 0.0) wind += fmt::format(" (planned for {:g} m/s)", options.wind_speed);
  items.push_back(wind + fmt::format("; battery at {:g} °C or warmer", options.temperature));
  items.push_back("Not verified: " + unverified_text(options, mission));
  items.push_back(fmt::format("Position error at most {:g} m ({}) before take-off",
                              options.position_error,
                              options.position_error < 0.5 ? "RTK fixed" : "GNSS"));
  items.push_back("Sensor: " + site.sensor + "; lens clean, storage empty, clock set");
  for (const std::string& note : mission.files.notes) items.push_back(note);
  return items;
}

std::vector<std::string> shortened(std::vector<std::string> items, std::size_t max) {
  if (items.size() <= max) return items;
  const std::size_t rest = items.size() - max;
  items.resize(max);
  items.push_back(fmt::format("{} more: see summary.json", rest));
  return items;
}

/// Returns text such as "12 m2 at (3, 4, 5), unobserved".
std::vector<std::string> missing_items(const SurveyMission& mission) {
  if (!mission.written) return {};
  const MissingSurface& missing = mission.written->parts.front().missing;
  double area = missing.smaller_area + missing.rest;
  for (const Hole& hole : missing.holes) area += hole.area;
  std::vector<std::string> items{
      fmt::format("{:.3g} of {:.4g} m² will be missing (red on the map)", area, missing.area)};
  for (std::size_t i = 0; i < std::min(max_holes, missing.holes.size()); ++i) {
    const Hole& hole = missing.holes[i];
    items.push_back(fmt::format("{:.3g} m² around ({:.0f}, {:.0f}, {:.0f}): {}", hole.area,
                                hole.centre.x(), hole.centre.y(), hole.centre.z(),
                                to_string(hole.reason)));
  }
  return items;
}

std::string pad_text(const flight::FlightOptions& options, const flight::Route& route) {
  const Vector3d& pad = route.options.takeoff;
  std::string text =
      fmt::format("Mission frame ({:.1f}, {:.1f}, {:.1f}) m", pad.x(), pad.y(), pad.z());
  if (!options.is_georeferenced) return text;
  const flight::GeodeticPoint point = flight::LocalFrame(options.site.origin).to_geodetic(pad);
  text = fmt::format("{:.7f}, {:.7f} (latitude, longitude). ", point.latitude_deg,
                     point.longitude_deg) +
         text;
  if (options.site.geoid_undulation) {
    text += fmt::format(", {:.1f} m AMSL", point.height - *options.site.geoid_undulation);
  }
  return text;
}

}  // namespace

std::string field_sheet(const FieldSheetSite& site, const flight::FlightOptions& options,
                        const SurveyMission& mission) {
  FieldSheetSite shown = site;
  if (mission.written) shown.is_covered = mission.written->parts.front().is_covered;
  if (shown.is_covered.size() != shown.surface.size()) shown.is_covered = {};
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" +
                     escaped(site.mission) + ": field sheet</title>\n<style>" + style +
                     "</style></head>\n<body>\n<div class=\"top\"><h1>" + escaped(site.mission) +
                     ": field sheet</h1><div class=\"fill\">Date <span></span> Pilot "
                     "<span></span> Observer <span></span></div></div>\n";
  html += Map(shown, options, mission).svg() + figures(site, mission);
  html += "<div class=\"columns\"><div>\n<h2>Take-off and landing</h2>\n";
  for (const VehicleRoute& vehicle_route : list_routes(mission)) {
    html += "<p>" + escaped(pad_text(options, *vehicle_route.route)) + "</p>\n";
  }
  for (const PilotSteps& part : pilot_steps(options, mission)) {
    html += "<h2>Before the flight: " + escaped(part.whom) + "</h2>\n" + list("ol", "", part.steps);
  }
  std::vector<std::string> warnings = site.warnings;
  for (std::string& warning : pilot_warnings(mission)) warnings.push_back(std::move(warning));
  if (!warnings.empty()) {
    html += "<h2>Warnings</h2>\n" + list("ul", "", shortened(std::move(warnings), max_warnings));
  }
  html += "</div><div>\n<h2>Check</h2>\n" +
          list("ul", " class=\"check\"", checks(options, mission, site));
  if (const auto items = missing_items(mission); !items.empty()) {
    html += "<h2>Expected gaps</h2>\n" + list("ul", "", items);
  }
  for (const SheetList& more : site.lists) {
    html += "<h2>" + escaped(more.title) + "</h2>\n" + list("ul", "", more.items);
  }
  html += "</div></div>\n<h2>Sorties and batteries</h2>\n" + sorties_table(mission);
  return html +
         "<p class=\"foot\">Arrows: view directions. Grey and red: surface to be surveyed, covered "
         "and not covered by the route files. Lengths in metres; energy from the vehicle model. "
         "Made by Skycap.</p>\n</body></html>\n";
}

}  // namespace skycap::missions::package
