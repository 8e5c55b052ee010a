#include "flight/export/wpml_file.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

#include <pugixml.hpp>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

constexpr double to_deg = 180.0 / std::numbers::pi;
constexpr const char* kml_namespace = "http://www.opengis.net/kml/2.2";
constexpr const char* wpml_namespace = "http://www.dji.com/wpmz/";
constexpr const char* stop_turn = "toPointAndStopWithDiscontinuityCurvature";

std::string xml_text(const pugi::xml_document& document) {
  std::ostringstream out;
  document.save(out, "  ", pugi::format_default, pugi::encoding_utf8);
  return out.str();
}

void add(pugi::xml_node parent, const std::string& name, const std::string& value) {
  parent.append_child(("wpml:" + name).c_str()).text().set(value.c_str());
}
pugi::xml_node add(pugi::xml_node parent, const std::string& name) {
  return parent.append_child(("wpml:" + name).c_str());
}

/// Writes either file; they share most of their elements.
class WpmlWriter {
 public:
  WpmlWriter(const FlightPlan& plan, bool is_template)
      : plan_(plan),
        is_template_(is_template),
        frame_(plan.site.origin),
        pad_(frame_.to_geodetic(plan.pad)) {
    for (const Waypoint& waypoint : plan.waypoints) highest_ = std::max(highest_, height(waypoint));
  }

  std::string write() {
    pugi::xml_document document;
    pugi::xml_node declaration = document.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "UTF-8";
    pugi::xml_node kml = document.append_child("kml");
    kml.append_attribute("xmlns") = kml_namespace;
    kml.append_attribute("xmlns:wpml") = (wpml_namespace + plan_.vehicle.wpml.version).c_str();
    pugi::xml_node root = kml.append_child("Document");
    if (is_template_) add(root, "author", "skycap");
    add_config(root);
    pugi::xml_node folder = root.append_child("Folder");
    is_template_ ? add_template_head(folder) : add_wayline_head(folder);
    for (std::size_t i = 0; i < plan_.waypoints.size(); ++i) add_waypoint(folder, i);
    if (is_template_) {
      pugi::xml_node payload = add(folder, "payloadParam");
      add(payload, "payloadPositionIndex", "0");
      add(payload, "imageFormat", "visable");  // spelt so by the format
    }
    return xml_text(document);
  }

 private:
  double height(const Waypoint& waypoint) const {
    return frame_.to_geodetic(waypoint.position).height - pad_.height;
  }
  std::string speed() const {
    return fixed(std::clamp(plan_.conditions.cruise_speed, 0.1, 15.0), 2);
  }

  void add_config(pugi::xml_node root) {
    pugi::xml_node config = add(root, "missionConfig");
    add(config, "flyToWaylineMode", "safely");
    add(config, "finishAction", "goHome");
    add(config, "exitOnRCLost", "executeLostAction");
    add(config, "executeRCLostAction", "goBack");
    const double first = height(plan_.waypoints.front());
    add(config, "takeOffSecurityHeight", fixed(std::clamp(first, 1.2, 1500.0), 2));
    add(config, "globalTransitionalSpeed", speed());
    add(config, "globalRTHHeight", fixed(plan_.certified_returns().height, 0));
    if (is_template_) {
      add(config, "takeOffRefPoint",
          degrees(pad_.latitude_deg) + "," + degrees(pad_.longitude_deg) + "," +
              fixed(pad_.height, 3));
      add(config, "takeOffRefPointAGLHeight", "0");
    }
    pugi::xml_node drone = add(config, "droneInfo");
    add(drone, "droneEnumValue", std::to_string(plan_.vehicle.wpml.drone));
    add(drone, "droneSubEnumValue", std::to_string(plan_.vehicle.wpml.drone_variant));
    pugi::xml_node payload = add(config, "payloadInfo");
    add(payload, "payloadEnumValue", std::to_string(plan_.vehicle.wpml.payload));
    add(payload, "payloadSubEnumValue", "0");
    add(payload, "payloadPositionIndex", "0");
  }

  void add_template_head(pugi::xml_node folder) {
    add(folder, "templateType", "waypoint");
    add(folder, "templateId", "0");
    pugi::xml_node system = add(folder, "waylineCoordinateSysParam");
    add(system, "coordinateMode", "WGS84");
    add(system, "heightMode", "relativeToStartPoint");
    add(system, "positioningType", "GPS");
    add(folder, "autoFlightSpeed", speed());
    add(folder, "globalHeight", fixed(highest_, 2));
    add(folder, "caliFlightEnable", "0");
    add(folder, "gimbalPitchMode", "manual");
    pugi::xml_node heading = add(folder, "globalWaypointHeadingParam");
    add(heading, "waypointHeadingMode", "smoothTransition");
    add(heading, "waypointHeadingAngle", "0");
    add(heading, "waypointHeadingPathMode", "followBadArc");
    add(folder, "globalWaypointTurnMode", stop_turn);
    add(folder, "globalUseStraightLine", "1");
  }

  void add_wayline_head(pugi::xml_node folder) {
    add(folder, "templateId", "0");
    add(folder, "executeHeightMode", "relativeToStartPoint");
    add(folder, "waylineId", "0");
    double distance = 0.0;
    for (std::size_t i = 1; i < plan_.waypoints.size(); ++i) {
      distance += (plan_.waypoints[i].position - plan_.waypoints[i - 1].position).norm();
    }
    add(folder, "distance", fixed(distance, 2));
    add(folder, "duration", fixed(stop_times(plan_).back().departure, 2));
    add(folder, "autoFlightSpeed", speed());
  }

  void add_waypoint(pugi::xml_node folder, std::size_t index) {
    const Waypoint& waypoint = plan_.waypoints[index];
    const GeodeticPoint place = frame_.to_geodetic(waypoint.position);
    pugi::xml_node mark = folder.append_child("Placemark");
    mark.append_child("Point")
        .append_child("coordinates")
        .text()
        .set((degrees(place.longitude_deg) + "," + degrees(place.latitude_deg)).c_str());
    add(mark, "index", std::to_string(index));
    if (is_template_) {
      add(mark, "useGlobalHeight", "0");
      add(mark, "ellipsoidHeight", fixed(height(waypoint), 3));
      add(mark, "height", fixed(height(waypoint), 3));
      add(mark, "useGlobalSpeed", "1");
      add(mark, "useGlobalHeadingParam", "0");
      add(mark, "useGlobalTurnParam", "1");
    } else {
      add(mark, "executeHeight", fixed(height(waypoint), 3));
      add(mark, "waypointSpeed", speed());
    }
    add_heading(mark, index);
    if (!is_template_) {
      pugi::xml_node turn = add(mark, "waypointTurnParam");
      add(turn, "waypointTurnMode", stop_turn);
      add(turn, "waypointTurnDampingDist", "0");
    }
    add(mark, "useStraightLine", "1");
    add_actions(mark, index);
  }

  /// A corner keeps the heading of the station to come.
  void add_heading(pugi::xml_node mark, std::size_t index) {
    auto station = std::find_if(plan_.waypoints.begin() + static_cast<std::ptrdiff_t>(index),
                                plan_.waypoints.end(),
                                [](const Waypoint& waypoint) { return waypoint.is_station; });
    const double yaw = station == plan_.waypoints.end() ? 0.0 : station->yaw;
    pugi::xml_node heading = add(mark, "waypointHeadingParam");
    add(heading, "waypointHeadingMode", "smoothTransition");
    add(heading, "waypointHeadingAngle",
        fixed(std::remainder(yaw, 2.0 * std::numbers::pi) * to_deg, 4));
    add(heading, "waypointHeadingPathMode", "followBadArc");  // the shortest way round
  }

  void add_actions(pugi::xml_node mark, std::size_t index) {
    const Waypoint& waypoint = plan_.waypoints[index];
    const std::string number = std::to_string(index);
    pugi::xml_node group = add(mark, "actionGroup");
    add(group, "actionGroupId", number);
    add(group, "actionGroupStartIndex", number);
    add(group, "actionGroupEndIndex", number);
    add(group, "actionGroupMode", "sequence");
    add(add(group, "actionTrigger"), "actionTriggerType", "reachPoint");
    int id = 0;
    const auto action = [&](const char* function) {
      pugi::xml_node node = add(group, "action");
      add(node, "actionId", std::to_string(id++));
      add(node, "actionActuatorFunc", function);
      return add(node, "actionActuatorFuncParam");
    };
    if (waypoint.is_station) add_gimbal(action("gimbalRotate"), waypoint);
    add(action("hover"), "hoverTime", fixed(waypoint.hold, 2));
    for (int shot = 0; shot < waypoint.shots; ++shot) {
      pugi::xml_node photo = action("takePhoto");
      add(photo, "payloadPositionIndex", "0");
      add(photo, "fileSuffix", "view_" + std::to_string(waypoint.view_index));
      add(photo, "useGlobalPayloadLensIndex", "1");
    }
    if (waypoint.hold_after > 0.0) add(action("hover"), "hoverTime", fixed(waypoint.hold_after, 2));
  }

  static void add_gimbal(pugi::xml_node gimbal, const Waypoint& waypoint) {
    add(gimbal, "gimbalHeadingYawBase", "north");
    add(gimbal, "gimbalRotateMode", "absoluteAngle");
    add(gimbal, "gimbalPitchRotateEnable", "1");
    add(gimbal, "gimbalPitchRotateAngle", fixed(waypoint.pitch * to_deg, 4));
    add(gimbal, "gimbalRollRotateEnable", "0");
    add(gimbal, "gimbalRollRotateAngle", "0");
    add(gimbal, "gimbalYawRotateEnable", "0");  // the vehicle's heading aims the camera
    add(gimbal, "gimbalYawRotateAngle", "0");
    add(gimbal, "gimbalRotateTimeEnable", "0");
    add(gimbal, "gimbalRotateTime", "0");
    add(gimbal, "payloadPositionIndex", "0");
  }

  const FlightPlan& plan_;
  bool is_template_;
  LocalFrame frame_;
  GeodeticPoint pad_;
  double highest_ = 0.0;
};

/// Checks either file and reads its places.
class WpmlChecker {
 public:
  WpmlChecker(const std::string& text, const std::string& file)
      : file_(file), is_template_(file == "template.kml") {
    const pugi::xml_parse_result parsed = document_.load_buffer(text.data(), text.size());
    if (!parsed) {
      complain(std::string("is not well-formed XML: ") + parsed.description());
      return;
    }
    check();
  }

  Problems problems;
  RouteFile route;
  std::string version;  ///< of the namespace

 private:
  void complain(const std::string& what) { problems.push_back(file_ + " " + what); }

  static std::string text_of(pugi::xml_node node, const char* name) {
    return node.child((std::string("wpml:") + name).c_str()).text().get();
  }

  void require_one_of(pugi::xml_node node, const char* name, const std::set<std::string>& values) {
    const std::string value = text_of(node, name);
    if (value.empty()) return complain("lacks wpml:" + std::string(name));
    if (!values.contains(value)) {
      complain("has wpml:" + std::string(name) + " \"" + value +
               "\", which is not one of its values");
    }
  }

  double require_number(pugi::xml_node node, const char* name, double low, double high) {
    const std::string text = text_of(node, name);
    const std::optional<double> value = to_number(text);
    if (!value || *value < low || *value > high) {
      complain((text.empty() ? "lacks wpml:" + std::string(name)
                             : "has wpml:" + std::string(name) + " " + text) +
               "; it must be a number in [" + fixed(low, 1) + ", " + fixed(high, 1) + "]");
      return 0.0;
    }
    return *value;
  }

  void check() {
    const pugi::xml_node kml = document_.child("kml");
    const std::string space = kml.attribute("xmlns:wpml").value();
    if (std::string(kml.attribute("xmlns").value()) != kml_namespace) {
      complain("must be in the namespace " + std::string(kml_namespace));
    }
    if (!space.starts_with(wpml_namespace)) {
      complain("must declare xmlns:wpml as " + std::string(wpml_namespace) + "VERSION");
    }
    version = space;
    const pugi::xml_node root = kml.child("Document"), folder = root.child("Folder");
    if (!root.child("wpml:missionConfig")) return complain("lacks wpml:missionConfig");
    check_config(root.child("wpml:missionConfig"));
    if (!folder) return complain("lacks Folder");
    require_number(folder, "templateId", 0, 65535);
    require_number(folder, "autoFlightSpeed", 0.01, 15);
    if (is_template_) {
      require_one_of(folder, "templateType", {"waypoint"});
      const pugi::xml_node system = folder.child("wpml:waylineCoordinateSysParam");
      require_one_of(system, "coordinateMode", {"WGS84"});
      require_one_of(
          system, "heightMode",
          {"EGM96", "relativeToStartPoint", "aboveGroundLevel", "realTimeFollowSurface"});
      set_datum(text_of(system, "heightMode"));
      require_one_of(folder, "gimbalPitchMode", {"manual", "usePointSetting"});
      require_one_of(folder, "globalWaypointTurnMode",
                     {stop_turn, "coordinateTurn", "toPointAndStopWithContinuityCurvature",
                      "toPointAndPassWithContinuityCurvature"});
    } else {
      require_number(folder, "waylineId", 0, 65535);
      require_one_of(folder, "executeHeightMode",
                     {"WGS84", "relativeToStartPoint", "realTimeFollowSurface"});
      set_datum(text_of(folder, "executeHeightMode"));
    }
    for (const pugi::xml_node mark : folder.children("Placemark")) check_waypoint(mark);
    if (route.points.size() < 2) complain("has fewer than two waypoints");
  }

  void set_datum(const std::string& mode) {
    if (mode == "EGM96") datum_ = HeightDatum::mean_sea_level;
    if (mode == "WGS84") datum_ = HeightDatum::ellipsoid;
    if (mode == "relativeToStartPoint") datum_ = HeightDatum::takeoff;
  }

  void check_config(pugi::xml_node config) {
    require_one_of(config, "flyToWaylineMode", {"safely", "pointToPoint"});
    require_one_of(config, "finishAction", {"goHome", "noAction", "autoLand", "gotoFirstWaypoint"});
    require_one_of(config, "exitOnRCLost", {"goContinue", "executeLostAction"});
    if (text_of(config, "exitOnRCLost") == "executeLostAction") {
      require_one_of(config, "executeRCLostAction", {"goBack", "landing", "hover"});
    }
    require_number(config, "takeOffSecurityHeight", 1.2, 1500);
    require_number(config, "globalTransitionalSpeed", 0.01, 15);
    if (!is_template_) route.return_height = require_number(config, "globalRTHHeight", 2, 1500);
    require_one_of(config.child("wpml:droneInfo"), "droneEnumValue",
                   {"60", "67", "77", "89", "91", "99", "100", "103"});
    require_number(config.child("wpml:droneInfo"), "droneSubEnumValue", 0, 3);
    require_number(config.child("wpml:payloadInfo"), "payloadEnumValue", 0, 65534);
    require_number(config.child("wpml:payloadInfo"), "payloadPositionIndex", 0, 2);
  }

  void check_waypoint(pugi::xml_node mark) {
    const std::string place = mark.child("Point").child("coordinates").text().get();
    const std::vector<std::string> parts = split(place, ',');
    const std::optional<double> longitude = to_number(parts[0]);
    const std::optional<double> latitude = to_number(parts.size() == 2 ? parts[1] : "");
    FilePoint point;
    point.datum = datum_;
    if (!longitude || !latitude || std::abs(*longitude) > 180.0 || std::abs(*latitude) > 90.0) {
      complain("has coordinates \"" + place + "\"; they must be longitude,latitude in degrees");
    } else {
      point.longitude_deg = *longitude, point.latitude_deg = *latitude;
    }
    if (text_of(mark, "index") != std::to_string(route.points.size())) {
      complain("has wpml:index " + text_of(mark, "index") + "; it must be " +
               std::to_string(route.points.size()));
    }
    if (is_template_) {
      point.height = require_number(mark, "height", -500, 10000);
      require_number(mark, "ellipsoidHeight", -500, 10000);
    } else {
      point.height = require_number(mark, "executeHeight", -500, 10000);
      require_number(mark, "waypointSpeed", 0.01, 15);
      check_turn(mark);
    }
    const pugi::xml_node heading = mark.child("wpml:waypointHeadingParam");
    require_one_of(heading, "waypointHeadingMode",
                   {"followWayline", "manually", "fixed", "smoothTransition", "towardPOI"});
    if (text_of(heading, "waypointHeadingMode") == "smoothTransition") {
      const double angle = require_number(heading, "waypointHeadingAngle", -180, 180);
      point.yaw_deg = angle < 0.0 ? angle + 360.0 : angle;
    }
    for (const pugi::xml_node group : mark.children("wpml:actionGroup")) check_group(group, point);
    route.points.push_back(point);
  }

  void check_turn(pugi::xml_node mark) {
    const pugi::xml_node turn = mark.child("wpml:waypointTurnParam");
    require_one_of(turn, "waypointTurnMode",
                   {stop_turn, "coordinateTurn", "toPointAndStopWithContinuityCurvature",
                    "toPointAndPassWithContinuityCurvature"});
    require_number(turn, "waypointTurnDampingDist", 0, 10000);
    if (text_of(turn, "waypointTurnMode") != stop_turn) {
      complain("has a turn that leaves the straight legs, so that no clearance can be proven");
    }
  }

  void check_group(pugi::xml_node group, FilePoint& point) {
    const double id = require_number(group, "actionGroupId", 0, 65535);
    if (!group_ids_.insert(id).second)
      complain("uses wpml:actionGroupId " + fixed(id, 0) + " twice");
    const double start = require_number(group, "actionGroupStartIndex", 0, 65535);
    require_number(group, "actionGroupEndIndex", start, 65535);
    require_one_of(group, "actionGroupMode", {"sequence"});
    require_one_of(group.child("wpml:actionTrigger"), "actionTriggerType",
                   {"reachPoint", "betweenAdjacentPoints", "multipleTiming", "multipleDistance"});
    for (const pugi::xml_node action : group.children("wpml:action")) {
      const std::string function = text_of(action, "actionActuatorFunc");
      const pugi::xml_node param = action.child("wpml:actionActuatorFuncParam");
      if (function == "hover") {
        point.hold += require_number(param, "hoverTime", 0, 3600);
      } else if (function == "gimbalRotate") {
        require_one_of(param, "gimbalRotateMode", {"absoluteAngle", "relativeAngle"});
        point.pitch_deg = require_number(param, "gimbalPitchRotateAngle", -120, 60);
      } else if (function == "takePhoto") {
        require_number(param, "payloadPositionIndex", 0, 2);
        if (std::isnan(point.pitch_deg))
          complain("has a takePhoto without a gimbalRotate before it");
        ++point.shots;
      } else if (function != "rotateYaw") {
        complain("has wpml:actionActuatorFunc \"" + function + "\", which is not known here");
      }
    }
  }

  std::string file_;
  bool is_template_;
  pugi::xml_document document_;
  std::set<double> group_ids_;
  HeightDatum datum_ = HeightDatum::ellipsoid;
};

}  // namespace

std::string write_kmz(const FlightPlan& plan) {
  if (plan.vehicle.dialect != Dialect::dji) {
    throw Error(ErrorKind::bad_config, "vehicle \"" + plan.vehicle.name +
                                           "\" does not fly DJI's missions; export plan for it");
  }
  if (plan.waypoints.size() > static_cast<std::size_t>(plan.vehicle.max_waypoints)) {
    throw Error(ErrorKind::bad_config,
                "\"" + plan.name + "\" has " + std::to_string(plan.waypoints.size()) +
                    " waypoints; vehicle \"" + plan.vehicle.name + "\" takes " +
                    std::to_string(plan.vehicle.max_waypoints));
  }
  return pack_kmz({WpmlWriter(plan, true).write(), WpmlWriter(plan, false).write()});
}

Problems validate_kmz(const std::string& bytes) {
  KmzContent content;
  try {
    content = unpack_kmz(bytes);
  } catch (const Error& error) {
    return {error.what()};
  }
  WpmlChecker edited(content.template_kml, "template.kml");
  const WpmlChecker flown(content.waylines_wpml, "waylines.wpml");
  Problems problems = edited.problems;
  problems.insert(problems.end(), flown.problems.begin(), flown.problems.end());
  if (!problems.empty()) return problems;
  // Pilot 2 may make the waylines anew from the template: the two must say the same.
  bool agree =
      edited.version == flown.version && edited.route.points.size() == flown.route.points.size();
  for (std::size_t i = 0; agree && i < flown.route.points.size(); ++i) {
    const FilePoint &a = edited.route.points[i], &b = flown.route.points[i];
    agree = a.latitude_deg == b.latitude_deg && a.longitude_deg == b.longitude_deg &&
            a.height == b.height && a.datum == b.datum && a.shots == b.shots;
  }
  if (!agree) problems.emplace_back("template.kml and waylines.wpml do not agree");
  return problems;
}

RouteFile read_kmz(const std::string& bytes) {
  throw_first(validate_kmz(bytes), "not a good .kmz file");
  return WpmlChecker(unpack_kmz(bytes).waylines_wpml, "waylines.wpml").route;
}

}  // namespace skycap::flight
