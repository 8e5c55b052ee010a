#include "flight/export/wpml_writer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <string>

#include <pugixml.hpp>

#include "flight/export/kml_document.h"
#include "flight/export/parameters.h"
#include "flight/export/scanner_commands.h"
#include "flight/export/text.h"
#include "geometry/angle.h"

namespace skycap::flight {
namespace {

using geometry::degrees_per_radian;

void add(pugi::xml_node parent, const std::string& name, const std::string& value) {
  parent.append_child(("wpml:" + name).c_str()).text().set(value.c_str());
}
pugi::xml_node add(pugi::xml_node parent, const std::string& name) {
  return parent.append_child(("wpml:" + name).c_str());
}

int wpml_payload(const FlightPlan& plan) {
  return plan.photo && plan.photo->payload != 0 ? plan.photo->payload : plan.vehicle.wpml.payload;
}

/// Whether it takes part in orientedShoot: M30 series, Mavic 3E and 3T, Matrice 3D and 4 series, by
/// the table of that action.
bool has_oriented_shoot(const Vehicle& vehicle) {
  constexpr int m30 = 67, mavic_3 = 77, matrice_3d = 91, matrice_4 = 99, mavic_3m = 68;
  const int drone = vehicle.wpml.drone;
  return vehicle.wpml.payload != mavic_3m &&
         (drone == m30 || drone == mavic_3 || drone == matrice_3d || drone == matrice_4);
}

/// An identifier that the aircraft writes into the photo: 32 hexadecimal digits of the FNV-1a hash
/// of the plan's name and the view, the same for the same plan.
std::string action_uuid(const std::string& name, std::uint32_t view) {
  constexpr std::uint64_t basis = 14695981039346656037ULL, prime = 1099511628211ULL;
  std::string id;
  for (const char* salt : {"a", "b"}) {
    std::uint64_t hash = basis;
    for (const char c : salt + name + "/" + std::to_string(view)) {
      hash = (hash ^ static_cast<unsigned char>(c)) * prime;
    }
    for (int shift = 60; shift >= 0; shift -= 4) id += "0123456789abcdef"[(hash >> shift) & 15U];
  }
  return id;
}

/// Writes either file. Both share most of their elements.
class WpmlWriter {
 public:
  WpmlWriter(const FlightPlan& plan, bool is_template)
      : plan_(plan),
        is_template_(is_template),
        frame_(plan.site.origin),
        pad_(frame_.to_geodetic(plan.pad)) {
    for (const Waypoint& waypoint : plan.waypoints)
      max_height_ = std::max(max_height_, height(waypoint));
    is_commanded_ = !commanded_scanner(plan.vehicle.wpml.payload).empty();
    recorded_ = recorded_waypoints(plan);
    filmed_ = recorded_stretch(plan);
  }

  std::string write() {
    pugi::xml_document document;
    pugi::xml_node kml =
        begin_kml(document, "xmlns:wpml", wpml::wpml_namespace + plan_.vehicle.wpml.version);
    pugi::xml_node root = kml.append_child("Document");
    if (is_template_) add(root, "author", "skycap");
    add_config(root);
    pugi::xml_node folder = root.append_child("Folder");
    is_template_ ? add_template_head(folder) : add_wayline_head(folder);
    for (std::size_t i = 0; i < plan_.waypoints.size(); ++i) add_waypoint(folder, i);
    if (is_template_) {
      pugi::xml_node payload = add(folder, "payloadParam");
      add(payload, "payloadPositionIndex", "0");
      add(payload, "imageFormat", plan_.photo ? plan_.photo->image_format : "visable");
      if (is_commanded_) add_scanner(payload);
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

  /// Non-repeating, and as many echoes as the format has words for at the full rate: the L1 has no
  /// third one there.
  void add_scanner(pugi::xml_node payload) const {
    const bool has_third = plan_.vehicle.wpml.payload != zenmuse_l1;
    add(payload, "returnMode", has_third ? "tripleReturn" : "dualReturn");
    add(payload, "samplingRate", "240000");
    add(payload, "scanningMode", "nonRepetitive");
    add(payload, "modelColoringEnable", "1");
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
    add(config, "globalRTHHeight", return_altitude_text(plan_.verified_returns().height));
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
    add(payload, "payloadEnumValue", std::to_string(wpml_payload(plan_)));
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
    add(folder, "globalHeight", fixed(max_height_, 2));
    add(folder, "caliFlightEnable", "0");
    add(folder, "gimbalPitchMode", "manual");
    pugi::xml_node heading = add(folder, "globalWaypointHeadingParam");
    add(heading, "waypointHeadingMode", "smoothTransition");
    add(heading, "waypointHeadingAngle", "0");
    add(heading, "waypointHeadingPathMode", "followBadArc");
    add(folder, "globalWaypointTurnMode", wpml::stop_turn);
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
    const GeodeticPoint geodetic = frame_.to_geodetic(waypoint.position);
    pugi::xml_node mark = folder.append_child("Placemark");
    mark.append_child("Point")
        .append_child("coordinates")
        .text()
        .set((degrees(geodetic.longitude_deg) + "," + degrees(geodetic.latitude_deg)).c_str());
    add(mark, "index", std::to_string(index));
    if (is_template_) {
      add(mark, "useGlobalHeight", "0");
      add(mark, "ellipsoidHeight", fixed(height(waypoint), 3));
      add(mark, "height", fixed(height(waypoint), 3));
      const bool has_own_speed = run_from(index) != nullptr || is_timed_from(index);
      add(mark, "useGlobalSpeed", has_own_speed ? "0" : "1");
      if (has_own_speed) add(mark, "waypointSpeed", speed_from(index));
      add(mark, "useGlobalHeadingParam", "0");
      add(mark, "useGlobalTurnParam", waypoint.is_passed ? "0" : "1");
    } else {
      add(mark, "executeHeight", fixed(height(waypoint), 3));
      add(mark, "waypointSpeed", speed_from(index));
    }
    add_heading(mark, index);
    if (!is_template_ || waypoint.is_passed) {
      pugi::xml_node turn = add(mark, "waypointTurnParam");
      add(turn, "waypointTurnMode", waypoint.is_passed ? wpml::passing_turn : wpml::stop_turn);
      add(turn, "waypointTurnDampingDist",
          waypoint.is_passed ? fixed(turn_radius(plan_, index), 3) : "0");
    }
    add(mark, "useStraightLine", "1");
    if (!waypoint.is_passed) add_actions(mark, index);
    if (is_timed_from(index)) add_even_pitch(mark, index);
    if (const PhotoRun* run = run_from(index)) add_run(mark, index, *run);
  }

  /// The photos without a stop on the leg that begins at a waypoint; nullptr if there are none.
  const PhotoRun* run_from(std::size_t index) const {
    if (index + 1 == plan_.waypoints.size() || !plan_.waypoints[index + 1].run) return nullptr;
    return &*plan_.waypoints[index + 1].run;
  }

  /// Returns true if the leg that begins at a waypoint has a planned duration.
  bool is_timed_from(std::size_t index) const {
    return index + 1 < plan_.waypoints.size() && plan_.waypoints[index + 1].leg_time > 0.0;
  }

  /// Of the leg that begins at a waypoint.
  std::string speed_from(std::size_t index) const {
    if (is_timed_from(index)) return fixed(std::min(leg_speed(plan_, index + 1), 15.0), 2);
    const PhotoRun* run = run_from(index);
    return run == nullptr ? speed() : fixed(std::min(run->speed, 15.0), 2);
  }

  /// A corner keeps the heading of the station to come; with a scanner, which measures meanwhile,
  /// that of the station before, so that the vehicle turns on the last piece of a leg as planned.
  double heading(std::size_t index) const {
    const auto is_capture_point = [](const Waypoint& waypoint) {
      return waypoint.is_capture_point;
    };
    const auto here = plan_.waypoints.begin() + static_cast<std::ptrdiff_t>(index);
    if (is_commanded_) {
      const auto before = std::find_if(std::make_reverse_iterator(here + 1), plan_.waypoints.rend(),
                                       is_capture_point);
      if (before != plan_.waypoints.rend()) return before->yaw;
    }
    const auto capture_point = std::find_if(here, plan_.waypoints.end(), is_capture_point);
    return capture_point == plan_.waypoints.end() ? 0.0 : capture_point->yaw;
  }

  void add_heading(pugi::xml_node mark, std::size_t index) {
    const double yaw = heading(index);
    pugi::xml_node heading = add(mark, "waypointHeadingParam");
    add(heading, "waypointHeadingMode", "smoothTransition");
    add(heading, "waypointHeadingAngle",
        fixed(std::remainder(yaw, 2.0 * std::numbers::pi) * degrees_per_radian, 4));
    add(heading, "waypointHeadingPathMode", "followBadArc");  // Shortest rotation.
  }

  void add_actions(pugi::xml_node mark, std::size_t index) {
    const Waypoint& waypoint = plan_.waypoints[index];
    const std::string number = std::to_string(index);
    pugi::xml_node group = add_group(mark, number, number);
    add(add(group, "actionTrigger"), "actionTriggerType", "reachPoint");
    int id = 0;
    const auto action = [&](const char* function) {
      pugi::xml_node node = add(group, "action");
      add(node, "actionId", std::to_string(id++));
      add(node, "actionActuatorFunc", function);
      return add(node, "actionActuatorFuncParam");
    };
    const bool is_start = is_commanded_ && index == recorded_.first;
    const bool is_stop = is_commanded_ && index == recorded_.last;
    if (is_start) {
      add_gimbal(action("gimbalRotate"), first_station());
    } else if (waypoint.is_capture_point && has_gimbal(waypoint)) {
      add_gimbal(action("gimbalRotate"), waypoint);
    }
    add(action("hover"), "hoverTime", fixed(waypoint.hold, 2));
    if (is_start || is_stop) {
      pugi::xml_node record = action("recordPointCloud");
      add(record, "payloadPositionIndex", "0");
      add(record, "recordPointCloudOperate", is_start ? "startRecord" : "stopRecord");
    }
    for (int capture = 0; capture < waypoint.captures; ++capture) {
      if (plan_.photo && has_oriented_shoot(plan_.vehicle)) {
        add_oriented_shoot(action("orientedShoot"), waypoint);
      } else {
        add_photo(action("takePhoto"), "view_" + std::to_string(waypoint.view_index));
      }
    }
    if (waypoint.hold_after > 0.0) add(action("hover"), "hoverTime", fixed(waypoint.hold_after, 2));
    if (filmed_.is_empty()) return;
    if (index == filmed_.first) {
      pugi::xml_node record = action("startRecord");
      add_photo(record, "inspection");
    }
    if (index == filmed_.last) {
      add(action("stopRecord"), "payloadPositionIndex", "0");
    }
  }

  /// The gimbal pitches evenly along the leg that begins at a waypoint.
  void add_even_pitch(pugi::xml_node mark, std::size_t index) {
    pugi::xml_node group = add_group(mark, std::to_string(index), std::to_string(index + 1));
    add(add(group, "actionTrigger"), "actionTriggerType", "betweenAdjacentPoints");
    pugi::xml_node action = add(group, "action");
    add(action, "actionId", "0");
    add(action, "actionActuatorFunc", "gimbalEvenlyRotate");
    pugi::xml_node gimbal = add(action, "actionActuatorFuncParam");
    add(gimbal, "gimbalPitchRotateAngle",
        fixed(plan_.waypoints[index + 1].pitch * degrees_per_radian, 4));
    add(gimbal, "payloadPositionIndex", "0");
  }

  pugi::xml_node add_group(pugi::xml_node mark, const std::string& first, const std::string& last) {
    pugi::xml_node group = add(mark, "actionGroup");
    add(group, "actionGroupId", std::to_string(groups_++));
    add(group, "actionGroupStartIndex", first);
    add(group, "actionGroupEndIndex", last);
    add(group, "actionGroupMode", "sequence");
    return group;
  }

  void add_photo(pugi::xml_node photo, const std::string& suffix) {
    add(photo, "payloadPositionIndex", "0");
    add(photo, "fileSuffix", suffix);
    add_lens(photo);
  }

  /// Files without a photo camera leave the lens to the template's payloadParam.
  void add_lens(pugi::xml_node photo) {
    if (plan_.photo) add(photo, "payloadLensIndex", plan_.photo->image_format);
    add(photo, "useGlobalPayloadLensIndex", plan_.photo ? "0" : "1");
  }

  /// The camera is aimed already. What the format needs of a photo to be repeated, and that does
  /// not exist, is left at the values that DJI's remote controllers write.
  void add_oriented_shoot(pugi::xml_node shoot, const Waypoint& waypoint) {
    const std::string yaw =
        fixed(std::remainder(waypoint.yaw, 2.0 * std::numbers::pi) * degrees_per_radian, 4);
    const std::string id = action_uuid(plan_.name, waypoint.view_index);
    add(shoot, "gimbalPitchRotateAngle", fixed(waypoint.pitch * degrees_per_radian, 4));
    add(shoot, "gimbalYawRotateAngle", yaw);  // must be the heading
    add(shoot, "focusX", "480");              // the middle of an image of 960 x 720
    add(shoot, "focusY", "360");
    add(shoot, "focusRegionWidth", "480");
    add(shoot, "focusRegionHeight", "360");
    add(shoot, "focalLength", "24");  // 35 mm equivalent of the wide camera, so no zoom
    add(shoot, "aircraftHeading", yaw);
    add(shoot, "accurateFrameValid", "0");  // repeats the pose, does not search for an object
    add(shoot, "payloadPositionIndex", "0");
    add_lens(shoot);
    add(shoot, "targetAngle", "0");
    add(shoot, "actionUUID", id);
    add(shoot, "imageWidth", "960");
    add(shoot, "imageHeight", "720");
    add(shoot, "AFPos", "0");
    add(shoot, "gimbalPort", "0");
    add(shoot, "orientedCameraType", std::to_string(wpml_payload(plan_)));
    add(shoot, "orientedFilePath", id);
    add(shoot, "orientedFileMD5", "");
    add(shoot, "orientedFileSize", "0");
    add(shoot, "orientedFileSuffix", "view_" + std::to_string(waypoint.view_index));
    add(shoot, "orientedPhotoMode", "normalPhoto");
  }

  /// Vehicle and gimbal keep the aim of the run's first photo.
  void add_run(pugi::xml_node mark, std::size_t index, const PhotoRun& run) {
    pugi::xml_node group = add_group(mark, std::to_string(index), std::to_string(index + 1));
    pugi::xml_node trigger = add(group, "actionTrigger");
    add(trigger, "actionTriggerType", "multipleDistance");
    add(trigger, "actionTriggerParam", fixed(run.spacing, 3));
    pugi::xml_node action = add(group, "action");
    add(action, "actionId", "0");
    add(action, "actionActuatorFunc", "takePhoto");
    add_photo(add(action, "actionActuatorFuncParam"), "run_" + std::to_string(index));
  }

  /// A scanner that is not of DJI is fixed to the airframe.
  bool has_gimbal(const Waypoint& waypoint) const {
    return plan_.vehicle.wpml.payload != psdk_payload || waypoint.captures > 0;
  }

  const Waypoint& first_station() const {
    const auto capture_point = std::ranges::find_if(
        plan_.waypoints, [](const Waypoint& waypoint) { return waypoint.is_capture_point; });
    return capture_point == plan_.waypoints.end() ? plan_.waypoints.front() : *capture_point;
  }

  static void add_gimbal(pugi::xml_node gimbal, const Waypoint& waypoint) {
    add(gimbal, "gimbalHeadingYawBase", "north");
    add(gimbal, "gimbalRotateMode", "absoluteAngle");
    add(gimbal, "gimbalPitchRotateEnable", "1");
    add(gimbal, "gimbalPitchRotateAngle", fixed(waypoint.pitch * degrees_per_radian, 4));
    add(gimbal, "gimbalRollRotateEnable", "0");
    add(gimbal, "gimbalRollRotateAngle", "0");
    add(gimbal, "gimbalYawRotateEnable", "0");  // The vehicle's heading aims the camera.
    add(gimbal, "gimbalYawRotateAngle", "0");
    add(gimbal, "gimbalRotateTimeEnable", "0");
    add(gimbal, "gimbalRotateTime", "0");
    add(gimbal, "payloadPositionIndex", "0");
  }

  const FlightPlan& plan_;
  bool is_template_;
  LocalFrame frame_;
  GeodeticPoint pad_;
  double max_height_ = 0.0;
  std::size_t groups_ = 0;     ///< that are written
  bool is_commanded_ = false;  ///< whether it carries a scanner that files command
  RecordedWaypoints recorded_;
  Recording filmed_;
};

}  // namespace

std::string template_kml(const FlightPlan& plan) { return WpmlWriter(plan, true).write(); }

std::string waylines_wpml(const FlightPlan& plan) { return WpmlWriter(plan, false).write(); }

}  // namespace skycap::flight
