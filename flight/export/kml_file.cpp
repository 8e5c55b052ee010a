#include <cmath>
#include <set>
#include <sstream>

#include <pugixml.hpp>

#include "flight/export/kml_document.h"
#include "flight/export/map_files.h"
#include "geometry/angle.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

using geometry::degrees_per_radian;
constexpr const char* google_namespace = "http://www.google.com/kml/ext/2.2";

/// Interval between the drawn points of a curve [s]. At typical accelerations, the chords deviate
/// from the curve by some millimetres, less than rounding_bound.
constexpr double curve_interval = 0.1;

/// Height above and below the pad to which unbounded no-fly volumes are drawn [m].
constexpr double drawn_height = 120.0;

/// Returns a date for the playable track. A simulated flight has no date, so it starts with the
/// year 2000.
std::string moment(double seconds) {
  const auto milliseconds = static_cast<long>(std::lround(seconds * 1000.0));
  const auto two = [](long n) { return (n < 10 ? "0" : "") + std::to_string(n); };
  const std::string fraction = std::to_string(1000 + milliseconds % 1000).substr(1);
  const long total = milliseconds / 1000;
  return "2000-01-" + two(1 + total / 86400) + "T" + two(total / 3600 % 24) + ":" +
         two(total / 60 % 60) + ":" + two(total % 60) + "." + fraction + "Z";
}

void add_element(pugi::xml_node parent, const char* name, const std::string& value) {
  parent.append_child(name).text().set(value.c_str());
}

class KmlWriter {
 public:
  explicit KmlWriter(const FlightPlan& plan)
      : plan_(plan),
        frame_(plan.site.origin),
        undulation_(plan.site.undulation_for("a .kml file")) {}

  std::string write() {
    pugi::xml_document document;
    pugi::xml_node kml = begin_kml(document, "xmlns:gx", google_namespace);
    pugi::xml_node root = kml.append_child("Document");
    add_element(root, "name", plan_.name);
    add_element(root, "description",
                "Heights above mean sea level; every leg is verified with a clearance of " +
                    fixed(plan_.clearance, 2) + " m.");
    add_style(root, "path", "LineStyle", "ff00aaff");
    add_style(root, "no_fly", "PolyStyle", "600000ff");
    add_path(root);
    for (const auto* waypoints : {&plan_.waypoints, &plan_.passed}) {
      for (const Waypoint& waypoint : *waypoints) {
        if (waypoint.is_capture_point) add_capture_point(root, waypoint);
      }
    }
    for (const Prism& prism : plan_.no_fly) add_volume(root, prism);
    add_track(root);
    return xml_text(document);
  }

 private:
  static void add_style(pugi::xml_node root, const char* id, const char* kind, const char* colour) {
    pugi::xml_node style = root.append_child("Style");
    style.append_attribute("id") = id;
    pugi::xml_node part = style.append_child(kind);
    add_element(part, "color", colour);  // Alpha, blue, green, red.
    if (std::string(kind) == "LineStyle") add_element(part, "width", "3");
  }

  std::string tuple(const Eigen::Vector3d& position, const char* separator) const {
    const GeodeticPoint geodetic = frame_.to_geodetic(position);
    return degrees(geodetic.longitude_deg) + separator + degrees(geodetic.latitude_deg) +
           separator + fixed(geodetic.height - undulation_, 3);
  }

  void add_path(pugi::xml_node root) {
    pugi::xml_node mark = root.append_child("Placemark");
    add_element(mark, "name", "path");
    add_element(mark, "styleUrl", "#path");
    pugi::xml_node line = mark.append_child("LineString");
    add_element(line, "extrude", "0"), add_element(line, "tessellate", "0"),
        add_element(line, "altitudeMode", "absolute");
    std::string coordinates;
    for (const Waypoint& waypoint : plan_.waypoints) {
      for (const double time : moments_on(waypoint)) {
        coordinates += " " + tuple(state_at(*waypoint.path_curve(), time).position, ",");
      }
      coordinates += (coordinates.empty() ? "" : " ") + tuple(waypoint.position, ",");
    }
    add_element(line, "coordinates", coordinates);
  }

  /// Returns times between the ends of the curve to the waypoint. Empty for a straight leg.
  static std::vector<double> moments_on(const Waypoint& waypoint) {
    std::vector<double> times;
    const double end = waypoint.path_curve() == nullptr ? 0.0 : duration(*waypoint.path_curve());
    for (int i = 1; i * curve_interval < end; ++i) times.push_back(i * curve_interval);
    return times;
  }

  void add_capture_point(pugi::xml_node root, const Waypoint& capture_point) {
    pugi::xml_node mark = root.append_child("Placemark");
    add_element(mark, "name", "view " + std::to_string(capture_point.view_index));
    // A double click moves the viewer to this pose.
    pugi::xml_node camera = mark.append_child("Camera");
    const GeodeticPoint geodetic = frame_.to_geodetic(capture_point.position);
    add_element(camera, "longitude", degrees(geodetic.longitude_deg));
    add_element(camera, "latitude", degrees(geodetic.latitude_deg));
    add_element(camera, "altitude", fixed(geodetic.height - undulation_, 3));
    add_element(camera, "heading", fixed(capture_point.yaw * degrees_per_radian, 4));
    add_element(camera, "tilt", fixed(90.0 + capture_point.pitch * degrees_per_radian, 4));
    add_element(camera, "roll", "0"), add_element(camera, "altitudeMode", "absolute");
    pugi::xml_node data = mark.append_child("ExtendedData");
    const auto add_data = [&](const char* name, const std::string& value) {
      pugi::xml_node entry = data.append_child("Data");
      entry.append_attribute("name") = name;
      add_element(entry, "value", value);
    };
    add_data("hold_s", fixed(capture_point.hold, 2));
    add_data("shots", std::to_string(capture_point.captures));
    add_data("clearance_m", fixed(capture_point.clearance, 3));
    pugi::xml_node point = mark.append_child("Point");
    add_element(point, "altitudeMode", "absolute");
    add_element(point, "coordinates", tuple(capture_point.position, ","));
  }

  /// Draws the outline at the ceiling, extruded to the ground as viewers do.
  void add_volume(pugi::xml_node root, const Prism& prism) {
    pugi::xml_node mark = root.append_child("Placemark");
    add_element(mark, "name", prism.name);
    add_element(mark, "styleUrl", "#no_fly");
    pugi::xml_node polygon = mark.append_child("Polygon");
    add_element(polygon, "extrude", "1"), add_element(polygon, "altitudeMode", "absolute");
    const double top = std::isfinite(prism.ceiling) ? prism.ceiling : plan_.pad.z() + drawn_height;
    std::string coordinates;
    // The first corner closes the ring.
    for (std::size_t i = 0; i <= prism.footprint.size(); ++i) {
      const Eigen::Vector2d& corner = prism.footprint[i % prism.footprint.size()];
      coordinates += (i == 0 ? "" : " ") + tuple({corner.x(), corner.y(), top}, ",");
    }
    add_element(polygon.append_child("outerBoundaryIs").append_child("LinearRing"), "coordinates",
                coordinates);
  }

  void add_track(pugi::xml_node root) {
    pugi::xml_node mark = root.append_child("Placemark");
    add_element(mark, "name", "flight");
    pugi::xml_node track = mark.append_child("gx:Track");
    add_element(track, "altitudeMode", "absolute");
    const std::vector<StopTime> times = stop_times(plan_);
    double left = 0.0;
    std::vector<std::string> moments, positions, angles;
    const auto add_position = [&](double time, const Eigen::Vector3d& geodetic, const Aim& aim) {
      moments.push_back(moment(time));
      positions.push_back(tuple(geodetic, " "));
      angles.push_back(fixed(aim.yaw * degrees_per_radian, 4) + " " +
                       fixed(90.0 + aim.pitch * degrees_per_radian, 4) + " 0");
    };
    for (std::size_t i = 0; i < times.size(); ++i) {
      const Waypoint& waypoint = plan_.waypoints[i];
      const auto aim_at = [&](double time) {
        return waypoint.fly_through ? waypoint.fly_through->aim_at(time)
                                    : Aim{waypoint.yaw, waypoint.pitch};
      };
      for (const double time : moments_on(waypoint)) {
        add_position(left + time, state_at(*waypoint.path_curve(), time).position, aim_at(time));
      }
      const Aim last = aim_at(times[i].arrival - left);
      add_position(times[i].arrival, waypoint.position, last);
      add_position(times[i].departure, waypoint.position, last);
      left = times[i].departure;
    }
    for (const std::string& text : moments) add_element(track, "when", text);
    for (const std::string& text : positions) add_element(track, "gx:coord", text);
    for (const std::string& text : angles) add_element(track, "gx:angles", text);
  }

  const FlightPlan& plan_;
  LocalFrame frame_;
  double undulation_;
};

class KmlChecker {
 public:
  explicit KmlChecker(const std::string& text) {
    const pugi::xml_parse_result parsed = document_.load_buffer(text.data(), text.size());
    if (!parsed) {
      problems.push_back(std::string("the file is not well-formed XML: ") + parsed.description());
      return;
    }
    const pugi::xml_node kml = document_.child("kml");
    if (std::string(kml.attribute("xmlns").value()) != kml_namespace) {
      problems.push_back("the root must be a kml element in " + std::string(kml_namespace));
      return;
    }
    for (const pugi::xpath_node node : document_.select_nodes("//Placemark")) check(node.node());
    if (route.points.size() < 2) {
      problems.emplace_back("missing Placemark \"path\" with a LineString of at least two points");
    }
  }

  Problems problems;
  RouteFile route;

 private:
  void add_problem(const std::string& who, const char* has, const std::string& value,
                   const char* right) {
    problems.push_back("\"" + who + "\" " + has + " \"" + geometry::excerpt(value) + "\"" + right);
  }

  void check(pugi::xml_node mark) {
    const std::string name = mark.child("name").text().get();
    for (const pugi::xml_node shape : mark.children()) {
      const std::string kind = shape.name();
      if (kind == "LineString" || kind == "Point" || kind == "Polygon") {
        const std::string mode = shape.child("altitudeMode").text().get();
        // Without "absolute", heights are ignored and the path would be drawn on the ground.
        if (mode != "absolute") {
          add_problem(name, "has altitudeMode", mode, "; it must be absolute");
        }
        const pugi::xpath_node found = shape.select_node(".//coordinates");
        const std::vector<FilePoint> positions = check_positions(found.node().text().get(), name);
        if (kind == "LineString" && name == "path") route.points = positions;
        if (kind == "Polygon") check_ring(positions, name);
      } else if (kind == "gx:Track") {
        check_track(shape, name);
      } else if (kind == "Camera") {
        const double tilt = shape.child("tilt").text().as_double(-1.0);
        if (tilt < 0.0 || tilt > 180.0)
          problems.push_back("\"" + name + "\" has a tilt outside the range 0 to 180 degrees");
      }
    }
  }

  std::vector<FilePoint> check_positions(const std::string& text, const std::string& name) {
    std::vector<FilePoint> positions;
    std::istringstream stream(text);
    for (std::string tuple; stream >> tuple;) {
      const std::vector<std::string> parts = split(tuple, ',');
      const auto number = [&](std::size_t i) {
        return i < parts.size() ? to_number(parts[i]) : std::nullopt;
      };
      const auto longitude = number(0), latitude = number(1), height = number(2);
      if (parts.size() != 3 || !longitude || !latitude || !height || std::abs(*longitude) > 180.0 ||
          std::abs(*latitude) > 90.0) {
        add_problem(name, "has the coordinates", tuple, "; they must be longitude,latitude,height");
        return positions;
      }
      FilePoint point{*latitude, *longitude, *height};
      point.datum = HeightDatum::mean_sea_level;
      positions.push_back(point);
    }
    if (positions.empty()) problems.push_back("\"" + name + "\" has no coordinates");
    return positions;
  }

  void check_ring(const std::vector<FilePoint>& ring, const std::string& name) {
    const bool is_closed = ring.size() >= 4 &&
                           ring.front().latitude_deg == ring.back().latitude_deg &&
                           ring.front().longitude_deg == ring.back().longitude_deg;
    if (!is_closed) {
      problems.push_back("\"" + name +
                         "\" must have at least 3 corners and end with its first one");
    }
  }

  void check_track(pugi::xml_node track, const std::string& name) {
    std::vector<std::string> moments;
    for (const pugi::xml_node when : track.children("when"))
      moments.emplace_back(when.text().get());
    const auto count = [&](const char* element) {
      const auto children = track.children(element);
      return static_cast<std::size_t>(std::distance(children.begin(), children.end()));
    };
    if (moments.empty() || count("gx:coord") != moments.size()) {
      problems.push_back("\"" + name + "\" must have as many gx:coord elements as when elements");
    }
    if (count("gx:angles") != 0 && count("gx:angles") != moments.size()) {
      problems.push_back("\"" + name +
                         "\" must have as many gx:angles elements as when elements, or none");
    }
    if (!std::is_sorted(moments.begin(), moments.end())) {
      problems.push_back("\"" + name + "\" has times that are not in ascending order");
    }
  }

  pugi::xml_document document_;
};

}  // namespace

std::string write_kml(const FlightPlan& plan) { return KmlWriter(plan).write(); }

Problems validate_kml(const std::string& text) { return KmlChecker(text).problems; }

RouteFile read_kml(const std::string& text) {
  const KmlChecker checker(text);
  throw_first(checker.problems, "invalid .kml file");
  return checker.route;
}

}  // namespace skycap::flight
