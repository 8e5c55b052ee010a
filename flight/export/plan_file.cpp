#include <algorithm>
#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "flight/export/mavlink_files.h"
#include "geometry/error.h"
#include "geometry/io/json.h"

namespace skycap::flight {
namespace {

using Json = nlohmann::ordered_json;

/// MAV_AUTOPILOT and MAV_TYPE.
constexpr int px4_firmware = 12, ardupilot_firmware = 3, quadrotor = 2;

/// Number of corners of the polygon for a circle.
constexpr int circle_corners = 64;

Json polygon(const Prism& prism, const LocalFrame& frame, bool is_inclusion) {
  Json corners = Json::array();
  for (const Eigen::Vector2d& corner : prism.footprint) {
    const GeodeticPoint geodetic = frame.to_geodetic({corner.x(), corner.y(), 0.0});
    corners.push_back(
        {rounded_degrees(geodetic.latitude_deg), rounded_degrees(geodetic.longitude_deg)});
  }
  return {{"inclusion", is_inclusion}, {"polygon", corners}, {"version", 1}};
}

Json item_json(const MissionItem& item, std::size_t id) {
  Json json{{"autoContinue", item.auto_continue},
            {"command", item.command},
            {"doJumpId", id},
            {"frame", item.frame},
            {"params", Json::array()},
            {"type", "SimpleItem"}};
  for (const double parameter : item.params) {
    json["params"].push_back(std::isnan(parameter) ? Json(nullptr) : Json(parameter));
  }
  if (item.frame == frame::relative) {
    json["AMSLAltAboveTerrain"] = nullptr;
    json["Altitude"] = item.params[6];
    json["AltitudeMode"] = 1;  // Relative to home.
  }
  return json;
}

/// Checks one file and collects problems in file order. Strict: the rules of the strictest loader.
/// Otherwise: the rules of QGroundControl since version 3.2 for its own files, which lack parts of
/// later versions.
class PlanChecker {
 public:
  PlanChecker(const std::string& text, bool is_strict)
      : is_strict_(is_strict), plan_(geometry::parse_json<Json>(text)) {}

  Problems check() {
    if (plan_.is_discarded() || !plan_.is_object()) {
      problems_.emplace_back("the file is not a JSON object");
      return std::move(problems_);
    }
    if (plan_.value("fileType", Json()) != Json("Plan")) add_problem("fileType must be \"Plan\"");
    require_version(plan_, "version", 1);
    if (is_strict_ && (!plan_.contains("groundStation") || !plan_["groundStation"].is_string())) {
      add_problem("groundStation must be a string");
    }
    if (const Json* mission = section("mission", 2)) check_mission(*mission);
    if (is_needed("geoFence")) {
      if (const Json* fence = section("geoFence", 2)) check_fence(*fence);
    }
    if (is_needed("rallyPoints")) {
      if (const Json* rally = section("rallyPoints", 2)) check_rally(*rally);
    }
    return std::move(problems_);
  }

  const MavlinkMission& file() const { return file_; }

 private:
  void add_problem(const std::string& what) { problems_.push_back(what); }

  /// Returns true if a section must be read. Files of QGroundControl 3.2 and of mission-only
  /// programs lack it, or have an empty section of version 1.
  bool is_needed(const char* name) const {
    if (is_strict_) return true;
    if (!plan_.contains(name) || plan_[name].is_null()) return false;
    const Json& part = plan_[name];
    if (!part.is_object() || part.value("version", Json()) != Json(1)) return true;
    return std::ranges::any_of(
        part, [](const Json& value) { return value.is_structured() && !value.empty(); });
  }

  void require_version(const Json& object, const std::string& where, int version) {
    if (!object.contains("version") || object["version"] != Json(version)) {
      add_problem(where + " must be " + std::to_string(version));
    }
  }

  const Json* section(const char* name, int version) {
    if (!plan_.contains(name) || !plan_[name].is_object()) {
      add_problem(std::string(name) + " is missing");
      return nullptr;
    }
    require_version(plan_[name], std::string(name) + ".version", version);
    return &plan_[name];
  }

  static bool are_numbers(const Json& json, std::size_t count) {
    return json.is_array() && json.size() == count &&
           std::all_of(json.begin(), json.end(), [](const Json& n) { return n.is_number(); });
  }

  void check_mission(const Json& mission) {
    check_home(mission.value("plannedHomePosition", Json()));
    if (!mission.contains("firmwareType") || !mission["firmwareType"].is_number_integer()) {
      if (is_strict_ || mission.contains("firmwareType")) {
        add_problem("mission.firmwareType must be an integer");
      }
    } else if (mission["firmwareType"] == px4_firmware) {
      file_.autopilot = AutopilotType::px4;
    } else if (mission["firmwareType"] == ardupilot_firmware) {
      file_.autopilot = AutopilotType::ardupilot;
    }
    if (!mission.contains("items") || !mission["items"].is_array() || mission["items"].empty()) {
      add_problem("mission.items must be a list with at least one item");
      return;
    }
    const std::size_t before = problems_.size();
    for (std::size_t i = 0; i < mission["items"].size(); ++i) check_item(mission["items"][i], i);
    if (problems_.size() > before) return;
    for (const std::string& problem : check_items(file_.items, file_.autopilot))
      add_problem(problem);
  }

  /// A home of zeros or nulls is unknown.
  void check_home(const Json& home) {
    const bool is_unknown = home.is_null() || home == Json({nullptr, nullptr, nullptr}) ||
                            (are_numbers(home, 3) && home[0] == 0.0 && home[1] == 0.0);
    if (!is_strict_ && is_unknown) return;
    if (!are_numbers(home, 3)) {
      return add_problem("mission.plannedHomePosition must be a list of three numbers");
    }
    file_.home = GeodeticPoint{home[0], home[1], home[2]};
  }

  /// Returns the seven parameters. Before QGroundControl 3.3 there were four, with a separate
  /// position. Null if neither form is present.
  Json parse_params(const Json& json) const {
    const auto is_list = [&](const char* key, std::size_t count) {
      return json.contains(key) && json[key].is_array() && json[key].size() == count;
    };
    if (is_list("params", 7)) return json["params"];
    if (is_strict_ || !is_list("coordinate", 3)) return nullptr;
    Json params = Json::array();
    for (std::size_t p = 0; p < 4; ++p) {
      const std::string key = "param" + std::to_string(p + 1);
      if (is_list("params", 4)) {
        params.push_back(json["params"][p]);
      } else if (json.contains(key)) {
        params.push_back(json[key]);
      } else {
        return nullptr;
      }
    }
    for (const Json& number : json["coordinate"]) params.push_back(number);
    return params;
  }

  /// Checks the number that ground stations show. Files of other programs lack it, and the order
  /// counts instead.
  bool check_jump_id(const Json& json, std::size_t i, const std::string& who) {
    const bool is_missing = !json.contains("doJumpId");
    if (!is_strict_ && is_missing) return true;
    const bool is_integer = !is_missing && json["doJumpId"].is_number_integer();
    if (is_strict_ && (!is_integer || json["doJumpId"] != Json(i + 1))) {
      add_problem(who + ".doJumpId must be " + std::to_string(i + 1));
      return false;
    }
    const long before = i == 0 ? 0 : static_cast<long>(file_.items.back().number);
    if (is_integer && json["doJumpId"] > Json(before) && json["doJumpId"] < Json(1'000'000)) {
      return true;
    }
    add_problem(who + ".doJumpId must be an integer greater than that of the previous item");
    return false;
  }

  void check_item(const Json& json, std::size_t i) {
    const std::string who = "mission.items[" + std::to_string(i) + "]";
    const auto is = [&](const char* key, auto test) {
      return json.contains(key) && test(json[key]);
    };
    const auto integer = [](const Json& value) { return value.is_number_integer(); };
    if (json.is_object() && json.value("type", Json()) == Json("ComplexItem")) {
      const Json kind = json.value("complexItemType", Json());
      return add_problem(who + ".type must be \"SimpleItem\", but is " +
                         (kind.is_string() ? kind.get<std::string>() : "pattern") +
                         " (ComplexItem); save it as waypoints first");
    }
    if (!json.is_object() || !is("type", [](const Json& v) { return v == "SimpleItem"; })) {
      return add_problem(who + ".type must be \"SimpleItem\"");
    }
    if (!is("command", integer)) return add_problem(who + ".command must be an integer");
    if (!is("frame", integer)) return add_problem(who + ".frame must be an integer");
    if (!is("autoContinue", [](const Json& v) { return v.is_boolean(); })) {
      return add_problem(who + ".autoContinue must be true or false");
    }
    if (file_.items.size() != i || !check_jump_id(json, i, who)) return;
    const Json params = parse_params(json);
    if (params.is_null()) return add_problem(who + ".params must be a list of 7 numbers or nulls");
    const std::size_t number =
        json.contains("doJumpId") ? json["doJumpId"].get<std::size_t>() : i + 1;
    MissionItem item{json["command"], json["frame"], {}, json["autoContinue"], number};
    for (std::size_t p = 0; p < 7; ++p) {
      const Json& value = params[p];
      if (!value.is_number() && !value.is_null()) {
        return add_problem(who + ".params must be a list of 7 numbers or nulls");
      }
      item.params[p] = value.is_null() ? unspecified : value.get<double>();
    }
    check_altitude(json, item, who);
    file_.items.push_back(item);
  }

  void check_altitude(const Json& json, const MissionItem& item, const std::string& who) {
    const bool has_mode = json.contains("AltitudeMode"), has_height = json.contains("Altitude");
    const bool has_terrain = json.contains("AMSLAltAboveTerrain");
    if (!has_mode && !has_height && !has_terrain) return;
    if (!is_strict_ && !has_mode) return;  // Frame and params suffice.
    if (is_strict_ && !(has_mode && has_height && has_terrain)) {
      return add_problem(
          who + " must have all or none of AltitudeMode, Altitude and AMSLAltAboveTerrain");
    }
    const Json mode = json["AltitudeMode"], above = json.value("AMSLAltAboveTerrain", Json());
    const Json height = json.value("Altitude", Json(item.params[6]));
    if (!mode.is_number_integer() || !height.is_number() ||
        !(above.is_null() || above.is_number())) {
      return add_problem(who +
                         " has an AltitudeMode, Altitude or AMSLAltAboveTerrain of the wrong type");
    }
    const bool agrees = (mode == 1 && item.frame == frame::relative) ||
                        ((mode == 2 || mode == 3) && item.frame == frame::global) ||
                        (mode == 4 && item.frame == frame::terrain);
    if (!agrees) add_problem(who + " has an AltitudeMode that conflicts with its frame");
    if (mode == 1 && height != Json(item.params[6])) {
      add_problem(who + ".Altitude must equal the height in its params");
    }
  }

  void check_fence(const Json& fence) {
    for (const char* kind : {"polygons", "circles"}) {
      if (!fence.contains(kind) || !fence[kind].is_array()) {
        add_problem("geoFence." + std::string(kind) + " must be a list");
        continue;
      }
      for (std::size_t i = 0; i < fence[kind].size(); ++i) {
        const std::string who = "geoFence." + std::string(kind) + "[" + std::to_string(i) + "]";
        check_area(fence[kind][i], kind[0] == 'p', who);
      }
    }
  }

  void check_area(const Json& area, bool is_polygon, const std::string& who) {
    require_version(area, who + ".version", 1);
    if (!area.contains("inclusion") || !area["inclusion"].is_boolean()) {
      return add_problem(who +
                         ".inclusion must be true or false; its default depends on the program");
    }
    FenceArea found{who, area["inclusion"], {}};
    if (is_polygon) {
      if (!area.contains("polygon") || !area["polygon"].is_array() || area["polygon"].size() < 3) {
        return add_problem(who + ".polygon must have at least 3 corners");
      }
      for (const Json& corner : area["polygon"]) {
        if (!are_numbers(corner, 2))
          return add_problem(who + ".polygon must contain pairs of numbers");
        found.corners.push_back({corner[0], corner[1], 0.0});
      }
      if (area["polygon"].front() == area["polygon"].back()) {
        return add_problem(who + ".polygon must not repeat its first corner at the end");
      }
    } else {
      const Json circle = area.value("circle", Json());
      const bool is_good = circle.is_object() && circle.contains("center") &&
                           are_numbers(circle["center"], 2) && circle.contains("radius") &&
                           circle["radius"].is_number() && circle["radius"] > 0.0;
      if (!is_good) return add_problem(who + ".circle must have a center and a positive radius");
      // Inscribed for a fence, circumscribed for a no-fly circle: the polygon is stricter than the
      // circle.
      const double widened =
          found.is_inclusion ? 1.0 : 1.0 / std::cos(std::numbers::pi / circle_corners);
      const LocalFrame centre({circle["center"][0], circle["center"][1], 0.0});
      for (int i = 0; i < circle_corners; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / circle_corners;
        const double radius = widened * circle["radius"].get<double>();
        found.corners.push_back(
            centre.to_geodetic({radius * std::cos(angle), radius * std::sin(angle), 0.0}));
      }
    }
    file_.fence.push_back(std::move(found));
  }

  void check_rally(const Json& rally) {
    if (!rally.contains("points") || !rally["points"].is_array()) {
      return add_problem("rallyPoints.points must be a list");
    }
    for (std::size_t i = 0; i < rally["points"].size(); ++i) {
      const Json& point = rally["points"][i];
      if (!are_numbers(point, 3)) {
        add_problem("rallyPoints.points[" + std::to_string(i) + "] must be three numbers");
        continue;
      }
      file_.rally.push_back(
          {point[0].get<double>(), point[1].get<double>(), point[2].get<double>()});
    }
  }

  bool is_strict_;
  Json plan_;
  MavlinkMission file_{.home_name = "mission.plannedHomePosition", .supports_fence = true};
  Problems problems_;
};

}  // namespace

std::string write_plan(const FlightPlan& plan) {
  const LocalFrame frame(plan.site.origin);
  const GeodeticPoint home = frame.to_geodetic(plan.pad);
  const double undulation = plan.site.undulation_for("a .plan file");
  Json items = Json::array();
  for (const MissionItem& item : mission_items(plan))
    items.push_back(item_json(item, items.size() + 1));

  Json polygons = Json::array();
  if (plan.fence) polygons.push_back(polygon(*plan.fence, frame, true));
  for (const Prism& prism : flat_no_fly(plan).written) {
    polygons.push_back(polygon(prism, frame, false));
  }
  // PX4 adds the return altitude to the point's height, and ArduPilot uses the larger of both. With
  // zero height above home, both return at the verified altitude and land on the ground.
  Json rally = Json::array();
  for (const Eigen::Vector3d& point : rally_points(plan)) {
    const GeodeticPoint geodetic = frame.to_geodetic(point);
    rally.push_back(
        {rounded_degrees(geodetic.latitude_deg), rounded_degrees(geodetic.longitude_deg), 0.0});
  }
  const Json file{
      {"fileType", "Plan"},
      {"groundStation", "QGroundControl"},
      {"version", 1},
      {"geoFence", {{"circles", Json::array()}, {"polygons", polygons}, {"version", 2}}},
      {"mission",
       {{"cruiseSpeed", plan.conditions.cruise_speed},
        {"firmwareType",
         plan.vehicle.autopilot == AutopilotType::px4 ? px4_firmware : ardupilot_firmware},
        {"globalPlanAltitudeMode", 1},
        {"hoverSpeed", plan.conditions.cruise_speed},
        {"items", items},
        {"plannedHomePosition",
         {rounded_degrees(home.latitude_deg), rounded_degrees(home.longitude_deg),
          std::round((home.height - undulation) * 1e3) / 1e3}},
        {"vehicleType", quadrotor},
        {"version", 2}}},
      {"rallyPoints", {{"points", rally}, {"version", 2}}}};
  return file.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Problems validate_plan(const std::string& text) { return PlanChecker(text, true).check(); }

MavlinkMission read_plan(const std::string& text) {
  PlanChecker checker(text, false);
  throw_first(checker.check(), "invalid .plan file");
  return checker.file();
}

}  // namespace skycap::flight
