#include "flight/interpreter/wpml_interpreter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include <pugixml.hpp>

#include "flight/export/scanner_commands.h"
#include "flight/interpreter/pad_column.h"
#include "flight/interpreter/photographs.h"
#include "flight/interpreter/recording.h"
#include "geometry/error.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Speeds and heights have two decimals.
constexpr double rounding = 0.01;

/// The only value of an element whose flight can be verified, and the effect of other values.
struct OnlyValue {
  const char* element;
  std::string_view right;
  const char* otherwise;
};

constexpr std::array mission_rules{
    OnlyValue{"flyToWaylineMode", "safely", "flies diagonally to the first waypoint"},
    OnlyValue{"exitOnRCLost", "executeLostAction", "continues without a link"},
    OnlyValue{"executeRCLostAction", "goBack", "hovers or lands at the position of the link loss"}};

constexpr std::array template_rules{
    OnlyValue{"globalWaypointTurnMode", "toPointAndStopWithDiscontinuityCurvature",
              "leaves the straight legs"},
    OnlyValue{"globalUseStraightLine", "1", "leaves the straight legs"},
    OnlyValue{"caliFlightEnable", "0", "starts a calibration flight, which is not verified"},
    OnlyValue{"gimbalPitchMode", "manual", "pitches the gimbal between waypoints"}};

constexpr std::array template_waypoint_rules{
    OnlyValue{"useGlobalHeight", "0", "overrides the height of the mission"},
    OnlyValue{"useStraightLine", "1", "leaves the straight legs"}};

constexpr std::array template_stop_rules{
    OnlyValue{"useGlobalTurnParam", "1", "overrides the turn mode of the mission"}};

constexpr std::array wayline_waypoint_rules{
    OnlyValue{"useStraightLine", "1", "leaves the straight legs"}};

constexpr std::array group_rules{
    OnlyValue{"actionGroupMode", "sequence", "does not execute its actions in sequence"}};

constexpr std::array gimbal_rules{
    OnlyValue{"gimbalRotateMode", "absoluteAngle", "sets a relative instead of an absolute pitch"},
    OnlyValue{"gimbalRollRotateEnable", "0", "rolls the gimbal"},
    OnlyValue{"gimbalYawRotateEnable", "0", "turns the gimbal away from the heading"}};

constexpr std::array oriented_rules{OnlyValue{
    "accurateFrameValid", "0", "turns the camera towards an object that it searches for"}};

/// Elements that are supported below each of these. All others are rejected.
constexpr std::array<std::string_view, 16> config_elements{"flyToWaylineMode",
                                                           "finishAction",
                                                           "exitOnRCLost",
                                                           "executeRCLostAction",
                                                           "takeOffSecurityHeight",
                                                           "globalTransitionalSpeed",
                                                           "globalRTHHeight",
                                                           "takeOffRefPoint",
                                                           "takeOffRefPointAGLHeight",
                                                           "droneInfo",
                                                           "payloadInfo",
                                                           "author",
                                                           "createTime",
                                                           "updateTime",
                                                           "waylineAvoidLimitAreaMode",
                                                           "isFixedFinishAction"};
constexpr std::array<std::string_view, 17> folder_elements{"templateType",
                                                           "templateId",
                                                           "waylineCoordinateSysParam",
                                                           "autoFlightSpeed",
                                                           "globalHeight",
                                                           "caliFlightEnable",
                                                           "gimbalPitchMode",
                                                           "globalWaypointHeadingParam",
                                                           "globalWaypointTurnMode",
                                                           "globalUseStraightLine",
                                                           "payloadParam",
                                                           "Placemark",
                                                           "executeHeightMode",
                                                           "waylineId",
                                                           "distance",
                                                           "duration",
                                                           "name"};
constexpr std::array<std::string_view, 18> waypoint_elements{"Point",
                                                             "index",
                                                             "useGlobalHeight",
                                                             "ellipsoidHeight",
                                                             "height",
                                                             "useGlobalSpeed",
                                                             "useGlobalHeadingParam",
                                                             "useGlobalTurnParam",
                                                             "executeHeight",
                                                             "waypointSpeed",
                                                             "waypointHeadingParam",
                                                             "waypointTurnParam",
                                                             "useStraightLine",
                                                             "actionGroup",
                                                             "isRisky",
                                                             "waypointWorkType",
                                                             "name",
                                                             "visibility"};

/// One of the two files.
class WpmlFlight {
 public:
  WpmlFlight(const std::string& text, std::string file, const FlightFacts& facts)
      : file_(std::move(file)), facts_(facts), frame_(facts.site.origin) {
    document_.load_buffer(text.data(), text.size());
    const pugi::xml_node root = document_.child("kml").child("Document");
    config_ = root.child("wpml:missionConfig");
    folder_ = root.child("Folder");
    if (folder_.next_sibling("Folder")) add_problem("has more than one wayline");
  }

  /// Returns the altitude reference of the template.
  std::optional<Vector3d> reference_pad() {
    const std::vector<std::string> parts = split(child_text(config_, "takeOffRefPoint"), ',');
    if (parts.size() != 3) return std::nullopt;
    const auto latitude = to_number(geometry::trimmed(parts[0])),
               longitude = to_number(geometry::trimmed(parts[1])),
               height = to_number(geometry::trimmed(parts[2]));
    if (!latitude || !longitude || !height) return std::nullopt;
    return frame_.to_local({*latitude, *longitude, *height});
  }

  /// Interprets the file. `positions` are the waypoints in the local frame [m].
  /// `curves` are the distances from them at which the aircraft may turn [m].
  InterpretedRoute fly(const std::vector<Vector3d>& positions, const std::vector<double>& curves,
                       const Vector3d& pad) {
    check_known(config_, config_elements, "");
    check_known(folder_, folder_elements, "");
    check_mission(positions, pad);
    climb(positions.front(), pad);
    std::size_t index = 0;
    double speed = unspecified;
    for (const pugi::xml_node mark : folder_.children("Placemark")) {
      if (index > 0) {
        const Departure departure = index > 1
                                        ? departure_after(route_.segments.back(), curves[index - 1])
                                        : Departure{{positions[0], positions[0]}};
        route_.segments.push_back(
            {departure.start, positions[index], waypoint(index - 1), waypoint(index)});
        route_.segments.back().speed = speed;
        route_.segments.back().margin = departure.margin;
        check_turns(positions, curves, index);
        if (photo_spacing_ > 0.0) append_passes(route_, photo_spacing_, yaw_deg_, pitch_deg_);
        legs_.push_back({positions[index - 1], positions[index], waypoint(index - 1),
                         waypoint(index), speed, is_recording_, heading_deg_, read_heading(mark),
                         pitch_deg_});
      }
      speed = read_speed(mark);
      is_passed_ = curves[index] > 0.0;
      check_waypoint(mark, index);
      heading_deg_ = read_heading(mark);
      act(mark, positions[index], index);
      ++index;
    }
    descend(positions.back(), pad, waypoint(index - 1));
    for (const std::string& problem : check_photographs(route_, facts_)) {
      route_.problems.push_back(problem);
    }
    for (const std::string& problem : check_recording(legs_, facts_)) {
      route_.problems.push_back(problem);
    }
    return std::move(route_);
  }

 private:
  /// Returns the speed on the leg from this waypoint, the global one if the waypoint uses it [m/s].
  double read_speed(pugi::xml_node mark) const {
    const bool is_global = child_text(mark, "useGlobalSpeed") == "1";
    return is_global ? child_number(folder_, "autoFlightSpeed")
                     : child_number(mark, "waypointSpeed");
  }

  bool is_template() const { return file_ == "template.kml"; }

  static std::string waypoint(std::size_t index) { return "waypoint " + std::to_string(index); }

  static std::string child_text(pugi::xml_node node, const char* name) {
    return std::string(
        geometry::trimmed(node.child((std::string("wpml:") + name).c_str()).text().get()));
  }

  /// Adds a problem. `who` is the waypoint; empty for the file.
  void add_problem(const std::string& what, const std::string& who = "") {
    route_.problems.push_back(who.empty() ? file_ + " " + what
                                          : who + " " + what + " (" + file_ + ")");
  }

  void check_known(pugi::xml_node node, std::span<const std::string_view> known,
                   const std::string& who) {
    for (const pugi::xml_node child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      std::string_view name = child.name();
      if (name.starts_with("wpml:")) name.remove_prefix(5);
      if (std::ranges::find(known, name) != known.end()) continue;
      add_problem("has " + std::string(child.name()) + ", which is not supported; remove it", who);
    }
  }

  /// Checks element values. The validator of the format reports missing elements.
  void check_values(pugi::xml_node node, std::span<const OnlyValue> rules,
                    const std::string& who = "") {
    for (const OnlyValue& rule : rules) {
      const std::string value = child_text(node, rule.element);
      if (value.empty() || value == rule.right) continue;
      add_problem("has wpml:" + std::string(rule.element) + " " + value + ", which " +
                      rule.otherwise + "; it must be " + std::string(rule.right),
                  who);
    }
  }

  double child_number(pugi::xml_node node, const char* name) const {
    return to_number(child_text(node, name)).value_or(unspecified);
  }

  void check_speed(pugi::xml_node node, const char* name, const std::string& who = "") {
    const double speed = child_number(node, name);
    if (std::isnan(speed) || speed <= facts_.cruise_speed + rounding) return;
    add_problem("has wpml:" + std::string(name) + " " + fixed(speed, 2) +
                    " m/s; the mission's cruise speed is " + fixed(facts_.cruise_speed, 2) + " m/s",
                who);
  }

  void check_height(const char* name, double min, const std::string& reason) {
    const double height = child_number(config_, name);
    if (std::isnan(height) || height >= min - rounding) return;
    add_problem("has wpml:" + std::string(name) + " " + fixed(height, 2) +
                " m; it must be at least " + fixed(min, 2) + " m, " + reason);
  }

  void check_mission(const std::vector<Vector3d>& positions, const Vector3d& pad) {
    check_values(config_, mission_rules);
    const std::string finish = child_text(config_, "finishAction");
    if (finish != "goHome" && finish != "autoLand") {
      add_problem("has wpml:finishAction " + finish +
                  ", which ends the mission in the air; it must be goHome or autoLand");
    }
    double max_height = 0.0;
    const double foot = frame_.to_geodetic(pad).height;
    for (const Vector3d& position : positions) {
      max_height = std::max(max_height, frame_.to_geodetic(position).height - foot);
    }
    check_height("takeOffSecurityHeight", facts_.takeoff_climb,
                 "the climb from the take-off point");
    check_height("globalRTHHeight", max_height, "the height of the highest waypoint");
    check_speed(config_, "globalTransitionalSpeed");
    check_speed(folder_, "autoFlightSpeed");
    if (is_template()) check_values(folder_, template_rules);
    for (const char* mode : {"aboveGroundLevel", "realTimeFollowSurface"}) {
      const pugi::xml_node system = folder_.child("wpml:waylineCoordinateSysParam");
      if (child_text(folder_, "executeHeightMode") == mode ||
          child_text(system, "heightMode") == mode) {
        add_problem(std::string("has heights relative to the ground (") + mode +
                    "), which is unknown");
      }
    }
    if (!facts_.vehicle || facts_.vehicle->autopilot != AutopilotType::dji) return;
    check_payload(facts_.vehicle->wpml.payload);
    const std::string drone = child_text(config_.child("wpml:droneInfo"), "droneEnumValue");
    if (drone == std::to_string(facts_.vehicle->wpml.drone)) return;
    add_problem("requires the aircraft with droneEnumValue " + drone + "; \"" +
                facts_.vehicle->name + "\" has " + std::to_string(facts_.vehicle->wpml.drone));
  }

  /// A camera may be another one than the vehicle's preset says; a scanner is what is flown for.
  void check_payload(int right) {
    const std::string payload = child_text(config_.child("wpml:payloadInfo"), "payloadEnumValue");
    if (commanded_scanner(right).empty() || payload == std::to_string(right)) return;
    add_problem("is for the payload with payloadEnumValue " + payload + "; the " +
                commanded_scanner(right) + " is " + std::to_string(right));
  }

  // Adds the climb of flyToWaylineMode "safely": up, level, then down to the first waypoint if it
  // is lower.
  void climb(const Vector3d& first, const Vector3d& pad) {
    const double security = child_number(config_, "takeOffSecurityHeight");
    const double top = std::max(first.z(), pad.z() + (std::isnan(security) ? 0.0 : security));
    const Vector3d over_pad(pad.x(), pad.y(), top), over_first(first.x(), first.y(), top);
    append_column(route_, {pad, over_pad}, {"the take-off point", waypoint(0)},
                  facts_.takeoff_climb);
    for (const Segment& leg : {Segment{over_pad, over_first}, Segment{over_first, first}}) {
      if (leg.length() < rounding) continue;
      route_.segments.push_back({{leg.from, leg.from}, leg.to, "the take-off point", waypoint(0)});
    }
  }

  // Within 5 m of home, the return is an immediate landing.
  void descend(const Vector3d& last, const Vector3d& pad, const std::string& who) {
    append_column(route_, {last, {last.x(), last.y(), pad.z()}}, {who, "the ground"},
                  facts_.takeoff_climb);
    const double away = (last - pad).head<2>().norm();
    if (away <= pad_tolerance) return;
    add_problem(
        "is the last waypoint, " + fixed(away, 1) +
            " m from the take-off point; neither the return nor the ground below it is verified",
        who);
  }

  void check_waypoint(pugi::xml_node mark, std::size_t index) {
    const std::string who = waypoint(index);
    check_known(mark, waypoint_elements, who);
    check_speed(mark, "waypointSpeed", who);
    if (is_template()) {
      check_values(mark, template_waypoint_rules, who);
      if (!is_passed_) check_values(mark, template_stop_rules, who);
    } else {
      check_values(mark, wayline_waypoint_rules, who);
    }
  }

  /// Heading on arrival at a waypoint; unspecified where the file leaves it to the aircraft [deg].
  static double read_heading(pugi::xml_node mark) {
    const pugi::xml_node heading = mark.child("wpml:waypointHeadingParam");
    const bool is_set = child_text(heading, "waypointHeadingMode") == "smoothTransition" &&
                        child_text(mark, "useGlobalHeadingParam") != "1";
    return is_set ? to_number(child_text(heading, "waypointHeadingAngle")).value_or(unspecified)
                  : unspecified;
  }

  /// Adds the actions at a waypoint in their order.
  void act(pugi::xml_node mark, const Vector3d& position, std::size_t index) {
    const std::string who = waypoint(index);
    double yaw_deg = read_heading(mark);
    double hold = 0.0;
    int captures = 0;
    photo_spacing_ = 0.0;
    for (const pugi::xml_node group : mark.children("wpml:actionGroup")) {
      check_group(group, index);
      const pugi::xml_node trigger = group.child("wpml:actionTrigger");
      const bool is_run = is_photo_run(child_text(trigger, "actionTriggerType"));
      if (is_run) photo_spacing_ = child_number(trigger, "actionTriggerParam");
      for (const pugi::xml_node action : group.children("wpml:action")) {
        const std::string function = child_text(action, "actionActuatorFunc");
        const pugi::xml_node param = action.child("wpml:actionActuatorFuncParam");
        if (function == "hover") {
          hold += child_number(param, "hoverTime");
          route_.segments.back().hold += child_number(param, "hoverTime");
          if (captures > 0) route_.stops.back().hold_after += child_number(param, "hoverTime");
        }
        if (is_run && function != "takePhoto") {
          add_problem("has wpml:actionActuatorFunc " + function +
                          " at equal distances; it must be takePhoto",
                      who);
        }
        if (function == "rotateYaw") yaw_deg = child_number(param, "aircraftHeading");
        if (function == "gimbalRotate") aim(param, who);
        if (function == "gimbalEvenlyRotate") {
          pitch_deg_ = child_number(param, "gimbalPitchRotateAngle");
        }
        if (is_passed_ && child_text(trigger, "actionTriggerType") == "reachPoint") {
          add_problem("has actions although it is passed without a stop", who);
        }
        if (function == "recordPointCloud") {
          const std::string operation = child_text(param, "recordPointCloudOperate");
          is_recording_ = operation == "startRecord" || operation == "resumeRecord";
        }
        if (function == "orientedShoot") yaw_deg = orient(param, who);
        if (is_run || (function != "takePhoto" && function != "orientedShoot")) continue;
        if (captures++ == 0) route_.stops.push_back({position, who, hold, yaw_deg, pitch_deg_, 0});
        ++route_.stops.back().captures;
      }
    }
    yaw_deg_ = yaw_deg;
  }

  /// Aims as the action says; returns the heading [deg].
  double orient(pugi::xml_node param, const std::string& who) {
    check_values(param, oriented_rules, who);
    pitch_deg_ = child_number(param, "gimbalPitchRotateAngle");
    const double heading = child_number(param, "aircraftHeading");
    const double gimbal = child_number(param, "gimbalYawRotateAngle");
    if (!(std::abs(std::remainder(heading - gimbal, 360.0)) <= rounding)) {
      add_problem("has wpml:gimbalYawRotateAngle " + fixed(gimbal, 2) +
                      " but wpml:aircraftHeading " + fixed(heading, 2) + "; they must be equal",
                  who);
    }
    return heading;
  }

  /// Turns must not overlap, and the aircraft must stop at both ends of the wayline.
  void check_turns(const std::vector<Vector3d>& positions, const std::vector<double>& curves,
                   std::size_t index) {
    const double length = (positions[index] - positions[index - 1]).norm();
    if (curves[index - 1] + curves[index] > length) {
      add_problem(
          "has a wpml:waypointTurnDampingDist that overlaps with that of the waypoint before",
          waypoint(index));
    }
    const bool is_last = index + 1 == positions.size();
    if ((index == 1 && curves[0] > 0.0) || (is_last && curves[index] > 0.0)) {
      add_problem("has a turn at an end of the wayline, where the aircraft must stop",
                  waypoint(is_last && curves[index] > 0.0 ? index : 0));
    }
  }

  bool is_photo_run(const std::string& trigger) const {
    return facts_.photo && trigger == "multipleDistance";
  }

  void aim(pugi::xml_node param, const std::string& who) {
    check_values(param, gimbal_rules, who);
    if (child_text(param, "gimbalPitchRotateEnable") == "0") return;
    pitch_deg_ = child_number(param, "gimbalPitchRotateAngle");
  }

  void check_group(pugi::xml_node group, std::size_t index) {
    check_values(group, group_rules, waypoint(index));
    const std::string trigger = child_text(group.child("wpml:actionTrigger"), "actionTriggerType");
    const bool is_run = is_photo_run(trigger) || trigger == "betweenAdjacentPoints";
    if (!is_run && trigger != "reachPoint") {
      add_problem("has wpml:actionTriggerType " + trigger + "; it must be reachPoint" +
                      (facts_.photo ? " or multipleDistance" : ""),
                  waypoint(index));
    }
    const auto require = [&](const char* end, std::size_t expected) {
      if (child_text(group, end) == std::to_string(expected)) return;
      add_problem("has wpml:" + std::string(end) + " " + child_text(group, end) +
                      "; its actions would run at other waypoints",
                  waypoint(index));
    };
    require("actionGroupStartIndex", index);
    require("actionGroupEndIndex", is_run ? index + 1 : index);
  }

  std::string file_;
  const FlightFacts& facts_;
  LocalFrame frame_;
  pugi::xml_document document_;
  pugi::xml_node config_, folder_;
  InterpretedRoute route_;
  double pitch_deg_ = unspecified;
  double yaw_deg_ = unspecified;      ///< at the waypoint before
  double photo_spacing_ = 0.0;        ///< on the leg from there; zero: no photos [m]
  double heading_deg_ = unspecified;  ///< at the waypoint before
  bool is_recording_ = false;         ///< a point cloud
  bool is_passed_ = false;            ///< the waypoint, without a stop
  std::vector<ScannedLeg> legs_;
};

/// Checks that the pad in the file, if any, is that of the mission.
void check_pad(const Vector3d& stated, const Vector3d& pad, Problems& problems) {
  const double level = (stated - pad).head<2>().norm(), up = stated.z() - pad.z();
  if (level <= pad_tolerance && std::abs(up) <= pad_height_tolerance) return;
  problems.push_back("in template.kml, wpml:takeOffRefPoint is " + fixed(level, 1) +
                     " m horizontally and " + fixed(up, 1) +
                     " m vertically from the mission's take-off point");
}

}  // namespace

InterpretedRoute interpret(const KmzContent& kmz, const FlightFacts& facts) {
  const RouteFile file = read_kmz(kmz);
  const bool is_editable = !kmz.template_kml.empty();
  WpmlFlight edited(is_editable ? kmz.template_kml : kmz.waylines_wpml,
                    is_editable ? "template.kml" : "waylines.wpml", facts);
  WpmlFlight executed(kmz.waylines_wpml, "waylines.wpml", facts);
  const std::optional<Vector3d> stated = edited.reference_pad();
  const std::vector<Vector3d> positions = local_points(file, facts.site, facts.pad);
  Vector3d pad = facts.pad;
  if (!facts.is_pad_known) pad.head<2>() = stated.value_or(positions.front()).head<2>();
  std::vector<double> curves;
  for (const FilePoint& point : file.points) curves.push_back(point.curve);
  InterpretedRoute route = executed.fly(positions, curves, pad);
  if (stated) check_pad(*stated, pad, route.problems);
  if (!is_editable) return route;
  for (const std::string& problem : edited.fly(positions, curves, pad).problems) {
    if (std::ranges::find(route.problems, problem) == route.problems.end()) {
      route.problems.push_back(problem);
    }
  }
  return route;
}

}  // namespace skycap::flight
