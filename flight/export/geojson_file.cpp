#include <cmath>

#include <nlohmann/json.hpp>

#include "flight/export/map_files.h"
#include "geometry/angle.h"
#include "geometry/io/json.h"

namespace skycap::flight {
namespace {

using Json = nlohmann::ordered_json;

using geometry::degrees_per_radian;

double rounded(double value, double steps) { return std::round(value * steps) / steps; }

class GeoJsonWriter {
 public:
  explicit GeoJsonWriter(const FlightPlan& plan)
      : plan_(plan), frame_(plan.site.origin), pad_(frame_.to_geodetic(plan.pad)) {}

  std::string write() {
    Json features = Json::array();
    Json path = Json::array();
    for (const Waypoint& waypoint : plan_.waypoints) path.push_back(coordinates(waypoint.position));
    features.push_back(feature("LineString", path,
                               {{"name", plan_.name},
                                {"vehicle", plan_.vehicle.name},
                                {"height_datum", "WGS84 ellipsoid"},
                                {"clearance_m", rounded(plan_.clearance, 1e3)}}));
    const std::vector<StopTime> times = stop_times(plan_);
    for (std::size_t i = 0; i < plan_.waypoints.size(); ++i) {
      if (plan_.waypoints[i].is_capture_point)
        features.push_back(capture_point(i, times[i].arrival));
    }
    for (const Prism& prism : plan_.no_fly) features.push_back(area(prism, false));
    if (plan_.fence) features.push_back(area(*plan_.fence, true));
    return Json{{"type", "FeatureCollection"}, {"features", features}}.dump(
               1, ' ', false, Json::error_handler_t::replace) +
           "\n";
  }

 private:
  static Json feature(const char* type, const Json& coordinates, const Json& properties) {
    return {{"type", "Feature"},
            {"geometry", {{"type", type}, {"coordinates", coordinates}}},
            {"properties", properties}};
  }

  Json coordinates(const Eigen::Vector3d& position) const {
    const GeodeticPoint geodetic = frame_.to_geodetic(position);
    return {rounded_degrees(geodetic.longitude_deg), rounded_degrees(geodetic.latitude_deg),
            rounded(geodetic.height, 1e3)};
  }

  Json capture_point(std::size_t index, double arrival) const {
    const Waypoint& stop = plan_.waypoints[index];
    const double height = frame_.to_geodetic(stop.position).height;
    const auto& undulation = plan_.site.geoid_undulation;
    return feature(
        "Point", coordinates(stop.position),
        {{"seq", index},
         {"view", stop.view_index},
         {"yaw_deg", rounded(stop.yaw * degrees_per_radian, 1e4)},
         {"gimbal_pitch_deg", rounded(stop.pitch * degrees_per_radian, 1e4)},
         {"hold_s", rounded(stop.hold, 1e3)},
         {"shots", stop.captures},
         {"speed_mps", plan_.conditions.cruise_speed},
         {"height_amsl_m", undulation ? Json(rounded(height - *undulation, 1e3)) : Json()},
         {"height_takeoff_m", rounded(height - pad_.height, 1e3)},
         {"clearance_m", rounded(stop.clearance, 1e3)},
         {"t_s", rounded(arrival, 1e3)}});
  }

  /// Exterior rings are closed and counter-clockwise (RFC 7946, section 3.1.6).
  Json area(const Prism& prism, bool is_inclusion) const {
    std::vector<Eigen::Vector2d> corners = prism.footprint;
    double twice_area = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
      twice_area += a.x() * b.y() - a.y() * b.x();
    }
    if (twice_area < 0.0) std::reverse(corners.begin(), corners.end());
    corners.push_back(corners.front());
    Json ring = Json::array();
    for (const Eigen::Vector2d& corner : corners) {
      Json geodetic = coordinates({corner.x(), corner.y(), 0.0});
      geodetic.erase(2);  // An area has no single height.
      ring.push_back(geodetic);
    }
    const auto height = [&](double z) {
      return std::isfinite(z) ? Json(rounded(frame_.to_geodetic({0, 0, z}).height, 1e3)) : Json();
    };
    return feature("Polygon", Json::array({ring}),
                   {{"name", prism.name},
                    {"inclusion", is_inclusion},
                    {"floor_m", height(prism.floor)},
                    {"ceiling_m", height(prism.ceiling)}});
  }

  const FlightPlan& plan_;
  LocalFrame frame_;
  GeodeticPoint pad_;
};

class GeoJsonChecker {
 public:
  explicit GeoJsonChecker(const std::string& text) {
    const Json file = geometry::parse_json<Json>(text);
    if (file.is_discarded() || !file.is_object() ||
        file.value("type", Json()) != "FeatureCollection" || !file.contains("features") ||
        !file["features"].is_array()) {
      problems.emplace_back("the file is not a GeoJSON FeatureCollection");
      return;
    }
    if (file.contains("crs"))
      problems.emplace_back("crs is not allowed in GeoJSON (RFC 7946); remove it");
    for (std::size_t i = 0; i < file["features"].size(); ++i) check_feature(file["features"][i], i);
    if (problems.empty() && route.points.empty()) {
      problems.emplace_back("the file contains no LineString; a flight requires at least one");
    }
  }

  Problems problems;
  RouteFile route;

 private:
  void check_feature(const Json& feature, std::size_t index) {
    const std::string who = "features[" + std::to_string(index) + "]";
    const bool is_feature = feature.is_object() && feature.value("type", Json()) == "Feature" &&
                            feature.contains("properties") && feature.contains("geometry") &&
                            feature["geometry"].is_object() &&
                            feature["geometry"].contains("coordinates");
    if (!is_feature) {
      problems.push_back(who + " is not a Feature with properties and a geometry");
      return;
    }
    const Json& coordinates = feature["geometry"]["coordinates"];
    const Json type = feature["geometry"].value("type", Json());
    if (type == "Point") {
      check_position(coordinates, who);
    } else if (type == "LineString") {
      check_line(coordinates, who);
    } else if (type == "Polygon") {
      check_polygon(coordinates, who);
    } else {
      problems.push_back(who + " has a geometry other than Point, LineString or Polygon");
    }
  }

  std::optional<FilePoint> check_position(const Json& geodetic, const std::string& who) {
    const bool is_good = geodetic.is_array() && (geodetic.size() == 2 || geodetic.size() == 3) &&
                         std::all_of(geodetic.begin(), geodetic.end(),
                                     [](const Json& n) { return n.is_number(); }) &&
                         std::abs(geodetic[0].get<double>()) <= 180.0 &&
                         std::abs(geodetic[1].get<double>()) <= 90.0;
    if (!is_good) {
      problems.push_back(who + " has a position that is not [longitude, latitude, height]");
      return std::nullopt;
    }
    return FilePoint{geodetic[1], geodetic[0],
                     geodetic.size() == 3 ? geodetic[2].get<double>() : unspecified};
  }

  void check_line(const Json& line, const std::string& who) {
    if (!line.is_array() || line.size() < 2) {
      problems.push_back(who + " is a LineString with fewer than two positions");
      return;
    }
    std::vector<FilePoint> points;
    for (const Json& geodetic : line) {
      const std::optional<FilePoint> point = check_position(geodetic, who);
      if (!point) return;
      if (std::isnan(point->height)) {
        problems.push_back(who + " has a position without a height");
        return;
      }
      points.push_back(*point);
    }
    if (route.points.empty()) route.points = points;
  }

  void check_polygon(const Json& polygon, const std::string& who) {
    if (!polygon.is_array() || polygon.empty()) {
      problems.push_back(who + " is a Polygon without a ring");
      return;
    }
    for (std::size_t r = 0; r < polygon.size(); ++r) {
      const Json& ring = polygon[r];
      if (!ring.is_array() || ring.size() < 4 || ring.front() != ring.back()) {
        problems.push_back(who + " has a ring that is not closed or has fewer than 4 positions");
        return;
      }
      double twice_area = 0.0;
      for (std::size_t i = 0; i < ring.size(); ++i) {
        if (!check_position(ring[i], who)) return;
        if (i == 0) continue;
        const auto x = [&](std::size_t k) {
          return ring[k][0].get<double>() - ring[0][0].get<double>();
        };
        const auto y = [&](std::size_t k) {
          return ring[k][1].get<double>() - ring[0][1].get<double>();
        };
        twice_area += x(i - 1) * y(i) - x(i) * y(i - 1);
      }
      if ((twice_area > 0.0) != (r == 0)) {
        problems.push_back(
            who +
            " has a ring in the wrong direction (outer rings counter-clockwise, holes clockwise)");
      }
    }
  }
};

}  // namespace

std::string write_geojson(const FlightPlan& plan) { return GeoJsonWriter(plan).write(); }

Problems validate_geojson(const std::string& text) { return GeoJsonChecker(text).problems; }

RouteFile read_geojson(const std::string& text) {
  const GeoJsonChecker checker(text);
  throw_first(checker.problems, "invalid .geojson file");
  return checker.route;
}

}  // namespace skycap::flight
