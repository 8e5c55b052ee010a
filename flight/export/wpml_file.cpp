#include "flight/export/wpml_file.h"

#include <cmath>
#include <set>

#include <pugixml.hpp>

#include "flight/export/kml_document.h"
#include "flight/export/wpml_writer.h"
#include "geometry/error.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

/// Checks one of the files and reads its positions. Strict: the rules for Skycap's own files.
/// Otherwise the return altitude may be missing, as in the samples of DJI's documentation.
class WpmlChecker {
 public:
  WpmlChecker(const std::string& text, const std::string& file, bool is_strict)
      : file_(file), is_template_(file == "template.kml"), is_strict_(is_strict) {
    const pugi::xml_parse_result parsed = document_.load_buffer(text.data(), text.size());
    if (!parsed) {
      add_problem(std::string("is not well-formed XML: ") + parsed.description());
      return;
    }
    check();
  }

  Problems problems;
  RouteFile route;
  std::vector<double> ellipsoid_heights;  ///< Waypoint heights of the template [m].
  std::string version;                    ///< Version of the namespace.

 private:
  void add_problem(const std::string& what) { problems.push_back(file_ + " " + what); }

  static std::string child_text(pugi::xml_node node, const char* name) {
    return std::string(
        geometry::trimmed(node.child((std::string("wpml:") + name).c_str()).text().get()));
  }

  void require_one_of(pugi::xml_node node, const char* name, const std::set<std::string>& values) {
    const std::string value = child_text(node, name);
    if (value.empty()) return add_problem("has no wpml:" + std::string(name));
    if (!values.contains(value)) {
      add_problem("has wpml:" + std::string(name) + " \"" + geometry::excerpt(value) +
                  "\", which is not a valid value");
    }
  }

  double require_number(pugi::xml_node node, const char* name, double low, double high) {
    const std::string text = child_text(node, name);
    const std::optional<double> value = to_number(text);
    if (!value || *value < low || *value > high) {
      add_problem((text.empty() ? "has no wpml:" + std::string(name)
                                : "has wpml:" + std::string(name) + " " + text) +
                  "; it must be a number from " + fixed(low, 1) + " to " + fixed(high, 1));
      return 0.0;
    }
    return *value;
  }

  void check() {
    const pugi::xml_node kml = document_.child("kml");
    const std::string space = kml.attribute("xmlns:wpml").value();
    if (std::string(kml.attribute("xmlns").value()) != kml_namespace) {
      add_problem("must be in the namespace " + std::string(kml_namespace));
    }
    if (!space.starts_with(wpml::wpml_namespace)) {
      add_problem("must declare xmlns:wpml as " + std::string(wpml::wpml_namespace) + "VERSION");
    }
    version = space;
    const pugi::xml_node root = kml.child("Document"), folder = root.child("Folder");
    if (!root.child("wpml:missionConfig")) return add_problem("has no wpml:missionConfig");
    check_config(root.child("wpml:missionConfig"));
    if (!folder) return add_problem("has no Folder");
    require_number(folder, "templateId", 0, 65535);
    require_number(folder, "autoFlightSpeed", 0.01, 15);
    if (is_template_) {
      require_one_of(folder, "templateType", {"waypoint"});
      const pugi::xml_node system = folder.child("wpml:waylineCoordinateSysParam");
      require_one_of(system, "coordinateMode", {"WGS84"});
      require_one_of(
          system, "heightMode",
          {"EGM96", "relativeToStartPoint", "aboveGroundLevel", "realTimeFollowSurface"});
      set_datum(child_text(system, "heightMode"));
      require_one_of(folder, "gimbalPitchMode", {"manual", "usePointSetting"});
      require_one_of(folder, "globalWaypointTurnMode",
                     {wpml::stop_turn, "coordinateTurn", "toPointAndStopWithContinuityCurvature",
                      "toPointAndPassWithContinuityCurvature"});
    } else {
      require_number(folder, "waylineId", 0, 65535);
      require_one_of(folder, "executeHeightMode",
                     {"WGS84", "relativeToStartPoint", "realTimeFollowSurface"});
      set_datum(child_text(folder, "executeHeightMode"));
    }
    for (const pugi::xml_node mark : folder.children("Placemark")) check_waypoint(mark);
    if (route.points.size() < 2) add_problem("has fewer than two waypoints");
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
    if (child_text(config, "exitOnRCLost") == "executeLostAction") {
      require_one_of(config, "executeRCLostAction", {"goBack", "landing", "hover"});
    }
    require_number(config, "takeOffSecurityHeight", 1.2, 1500);
    require_number(config, "globalTransitionalSpeed", 0.01, 15);
    if (!is_template_ && (is_strict_ || !child_text(config, "globalRTHHeight").empty())) {
      route.return_height = require_number(config, "globalRTHHeight", 2, 1500);
    }
    // DJI documents all codes except 68, which DJI Fly writes for consumer drones.
    require_one_of(config.child("wpml:droneInfo"), "droneEnumValue",
                   {"60", "67", "68", "77", "89", "91", "99", "100", "103"});
    require_number(config.child("wpml:droneInfo"), "droneSubEnumValue", 0, 3);
    require_number(config.child("wpml:payloadInfo"), "payloadEnumValue", 0, 99999);
    require_number(config.child("wpml:payloadInfo"), "payloadPositionIndex", 0, 2);
  }

  void check_waypoint(pugi::xml_node mark) {
    const std::string location(
        geometry::trimmed(mark.child("Point").child("coordinates").text().get()));
    const std::vector<std::string> parts = split(location, ',');
    const std::optional<double> longitude = to_number(geometry::trimmed(parts[0]));
    const std::optional<double> latitude =
        to_number(parts.size() == 2 ? geometry::trimmed(parts[1]) : "");
    FilePoint point;
    point.datum = datum_;
    if (!longitude || !latitude || std::abs(*longitude) > 180.0 || std::abs(*latitude) > 90.0) {
      add_problem("has coordinates \"" + geometry::excerpt(location) +
                  "\"; they must be longitude,latitude in degrees");
    } else {
      point.longitude_deg = *longitude, point.latitude_deg = *latitude;
    }
    if (child_text(mark, "index") != std::to_string(route.points.size())) {
      add_problem("has wpml:index " + child_text(mark, "index") + "; it must be " +
                  std::to_string(route.points.size()));
    }
    if (is_template_) {
      point.height = require_number(mark, "height", -500, 10000);
      ellipsoid_heights.push_back(require_number(mark, "ellipsoidHeight", -500, 10000));
    } else {
      point.height = require_number(mark, "executeHeight", -500, 10000);
      require_number(mark, "waypointSpeed", 0.01, 15);
    }
    if (!is_template_ || mark.child("wpml:waypointTurnParam")) check_turn(mark, point);
    if (is_template_ && child_text(mark, "useGlobalSpeed") == "0") {
      require_number(mark, "waypointSpeed", 0.01, 15);
    }
    const pugi::xml_node heading = mark.child("wpml:waypointHeadingParam");
    require_one_of(heading, "waypointHeadingMode",
                   {"followWayline", "manually", "fixed", "smoothTransition", "towardPOI"});
    if (child_text(heading, "waypointHeadingMode") == "smoothTransition") {
      const double angle = require_number(heading, "waypointHeadingAngle", -180, 180);
      point.yaw_deg = angle < 0.0 ? angle + 360.0 : angle;
    }
    for (const pugi::xml_node group : mark.children("wpml:actionGroup")) check_group(group, point);
    route.points.push_back(point);
  }

  void check_turn(pugi::xml_node mark, FilePoint& point) {
    const pugi::xml_node turn = mark.child("wpml:waypointTurnParam");
    require_one_of(turn, "waypointTurnMode",
                   {wpml::stop_turn, "coordinateTurn", "toPointAndStopWithContinuityCurvature",
                    "toPointAndPassWithContinuityCurvature"});
    const double damping = require_number(turn, "waypointTurnDampingDist", 0, 10000);
    const std::string mode = child_text(turn, "waypointTurnMode");
    if (mode == wpml::passing_turn && damping > 0.0) {
      point.curve = damping;
    } else if (mode != wpml::stop_turn) {
      add_problem(
          "has a turn mode that leaves the straight legs; its clearance cannot be verified");
    }
  }

  void check_group(pugi::xml_node group, FilePoint& point) {
    const double id = require_number(group, "actionGroupId", 0, 65535);
    if (!group_ids_.insert(id).second)
      add_problem("uses wpml:actionGroupId " + fixed(id, 0) + " twice");
    const double start = require_number(group, "actionGroupStartIndex", 0, 65535);
    require_number(group, "actionGroupEndIndex", start, 65535);
    require_one_of(group, "actionGroupMode", {"sequence"});
    require_one_of(group.child("wpml:actionTrigger"), "actionTriggerType",
                   {"reachPoint", "betweenAdjacentPoints", "multipleTiming", "multipleDistance"});
    const std::string trigger = child_text(group.child("wpml:actionTrigger"), "actionTriggerType");
    if (trigger == "multipleDistance") {
      require_number(group.child("wpml:actionTrigger"), "actionTriggerParam", 0.01, 10000);
    }
    for (const pugi::xml_node action : group.children("wpml:action")) {
      const std::string function = child_text(action, "actionActuatorFunc");
      const pugi::xml_node param = action.child("wpml:actionActuatorFuncParam");
      if (function == "hover") {
        point.hold += require_number(param, "hoverTime", 0, 3600);
      } else if (function == "gimbalRotate") {
        require_one_of(param, "gimbalRotateMode", {"absoluteAngle", "relativeAngle"});
        point.pitch_deg = require_number(param, "gimbalPitchRotateAngle", -120, 60);
      } else if (function == "takePhoto") {
        require_number(param, "payloadPositionIndex", 0, 2);
        check_lens(param);
        if (std::isnan(point.pitch_deg))
          add_problem("has a takePhoto without a gimbalRotate before it");
        if (trigger == "multipleDistance") {
          point.photo_spacing =
              to_number(child_text(group.child("wpml:actionTrigger"), "actionTriggerParam"))
                  .value_or(0.0);
        } else {
          ++point.captures;
        }
      } else if (function == "orientedShoot") {
        require_number(param, "payloadPositionIndex", 0, 2);
        point.pitch_deg = require_number(param, "gimbalPitchRotateAngle", -120, 60);
        require_number(param, "gimbalYawRotateAngle", -180, 180);
        require_number(param, "aircraftHeading", -180, 180);
        require_one_of(param, "accurateFrameValid", {"0", "1"});
        check_action_id(child_text(param, "actionUUID"));
        ++point.captures;
        check_lens(param);
      } else if (function == "recordPointCloud") {
        require_number(param, "payloadPositionIndex", 0, 2);
        require_one_of(param, "recordPointCloudOperate",
                       {"startRecord", "pauseRecord", "resumeRecord", "stopRecord"});
      } else if (function == "gimbalEvenlyRotate") {
        require_number(param, "gimbalPitchRotateAngle", -120, 60);
        require_number(param, "payloadPositionIndex", 0, 2);
        if (trigger != "betweenAdjacentPoints") {
          add_problem("has a gimbalEvenlyRotate without the trigger betweenAdjacentPoints");
        }
      } else if (function == "startRecord" || function == "stopRecord") {
        require_number(param, "payloadPositionIndex", 0, 2);
        check_lens(param);
      } else if (function != "rotateYaw") {
        add_problem("has wpml:actionActuatorFunc \"" + function + "\", which is not supported");
      }
    }
  }

  /// Aircraft ignore kinds of images that are spelt otherwise.
  void check_lens(pugi::xml_node param) {
    const std::string kinds = child_text(param, "payloadLensIndex");
    if (kinds.empty()) return;
    for (const std::string& kind : split(kinds, ',')) {
      if (!std::set<std::string>{"visable", "wide", "zoom", "ir", "narrow_band"}.contains(kind)) {
        add_problem("has wpml:payloadLensIndex \"" + kinds + "\", which is not a valid value");
      }
    }
  }

  void check_action_id(const std::string& id) {
    if (id.empty()) return add_problem("has an orientedShoot without wpml:actionUUID");
    if (!action_ids_.insert(id).second) add_problem("uses wpml:actionUUID " + id + " twice");
  }

  std::string file_;
  bool is_template_, is_strict_;
  std::set<std::string> action_ids_;
  pugi::xml_document document_;
  std::set<double> group_ids_;
  HeightDatum datum_ = HeightDatum::ellipsoid;
};

}  // namespace

std::string write_kmz(const FlightPlan& plan) {
  if (plan.vehicle.autopilot != AutopilotType::dji) {
    throw Error(ErrorKind::bad_config, "vehicle \"" + plan.vehicle.name +
                                           "\" does not support DJI missions; use --format plan");
  }
  if (plan.waypoints.size() > static_cast<std::size_t>(plan.vehicle.max_waypoints)) {
    throw Error(ErrorKind::bad_config,
                "\"" + plan.name + "\" has " + std::to_string(plan.waypoints.size()) +
                    " waypoints; vehicle \"" + plan.vehicle.name + "\" accepts " +
                    std::to_string(plan.vehicle.max_waypoints));
  }
  return pack_kmz({template_kml(plan), waylines_wpml(plan)});
}

namespace {

/// Returns true if both files have the same positions and photos. Pilot 2 writes a template above
/// the geoid with waylines above the ellipsoid; the template then contains both heights.
bool agree(const WpmlChecker& edited, const WpmlChecker& executed) {
  constexpr double same_degrees = 1e-8, same_height = 1e-3;
  if (edited.version != executed.version) return false;
  if (edited.route.points.size() != executed.route.points.size()) return false;
  for (std::size_t i = 0; i < executed.route.points.size(); ++i) {
    const FilePoint &a = edited.route.points[i], &b = executed.route.points[i];
    const bool are_both =
        a.datum == HeightDatum::mean_sea_level && b.datum == HeightDatum::ellipsoid;
    const double height = are_both ? edited.ellipsoid_heights[i] : a.height;
    if (std::abs(a.latitude_deg - b.latitude_deg) > same_degrees ||
        std::abs(a.longitude_deg - b.longitude_deg) > same_degrees ||
        std::abs(height - b.height) > same_height || (a.datum != b.datum && !are_both) ||
        a.captures != b.captures || a.photo_spacing != b.photo_spacing || a.curve != b.curve) {
      return false;
    }
  }
  return true;
}

/// Without a template, only the waylines are checked, because the aircraft flies only them.
Problems find_problems(const KmzContent& content, bool is_strict) {
  const WpmlChecker executed(content.waylines_wpml, "waylines.wpml", is_strict);
  if (content.template_kml.empty()) {
    if (is_strict) return {"the file wpmz/template.kml is missing"};
    return executed.problems;
  }
  const WpmlChecker edited(content.template_kml, "template.kml", is_strict);
  Problems problems = edited.problems;
  problems.insert(problems.end(), executed.problems.begin(), executed.problems.end());
  // Pilot 2 may regenerate the waylines from the template, so both must be equivalent.
  if (problems.empty() && !agree(edited, executed)) {
    problems.emplace_back("template.kml and waylines.wpml differ");
  }
  return problems;
}

}  // namespace

Problems validate_kmz(const std::string& bytes) {
  try {
    return find_problems(unpack_kmz(bytes), true);
  } catch (const Error& error) {
    return {error.what()};
  }
}

RouteFile read_kmz(const std::string& bytes) { return read_kmz(unpack_kmz(bytes)); }

RouteFile read_kmz(const KmzContent& content) {
  throw_first(find_problems(content, false), "invalid .kmz file");
  return WpmlChecker(content.waylines_wpml, "waylines.wpml", false).route;
}

}  // namespace skycap::flight
