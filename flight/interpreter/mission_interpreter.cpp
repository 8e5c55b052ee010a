#include "flight/interpreter/mission_interpreter.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "flight/autopilot/mission_mode.h"
#include "flight/interpreter/command_table.h"
#include "flight/interpreter/fence_check.h"
#include "flight/interpreter/home_check.h"
#include "flight/interpreter/item_order.h"
#include "flight/interpreter/pad_column.h"
#include "flight/interpreter/photographs.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// PX4's NAV_ACC_RAD, used for items without a radius [m].
constexpr double default_radius_px4 = 10.0;

/// WPNAV_SPEED and MPC_XY_CRUISE, used if no item sets a speed [m/s].
constexpr double default_speed_ardupilot = 10.0, default_speed_px4 = 5.0;

/// MAV_MOUNT_MODE_MAVLINK_TARGETING.
constexpr double aims_by_angles = 2.0;

constexpr double min_photo_spacing = 0.1;  // [m]

constexpr double longest_wait = 600.0;  // more is taken for a mistake [s]

/// Execution of the items of a file.
class MissionFlight {
 public:
  MissionFlight(const MavlinkMission& file, AutopilotType autopilot, const FlightFacts& facts)
      : file_(file),
        autopilot_(autopilot),
        facts_(facts),
        frame_(facts.site.origin),
        items_(as_stored(file.items, autopilot)) {}

  InterpretedRoute fly() {
    for (const std::string& problem : check_items(file_.items, autopilot_)) add(problem);
    const ItemOrder order = compute_order(items_);
    for (const std::string& problem : order.problems) add(problem);
    for (const std::size_t i : order.indices) upcoming_.push_back(&items_[i]);
    while (!upcoming_.empty()) {
      const MissionItem& item = *upcoming_.front();
      upcoming_.pop_front();
      step(item);
    }
    if (!has_landed_) add("the mission ends in the air, without a landing (21)");
    std::optional<Vector3d> pad;  // Known from the mission or from the take-off item.
    if (has_taken_off_) pad = pad_;
    for (const std::string& problem : check_home(file_, pad, facts_)) add(problem);
    for (const std::string& problem : check_rally(file_, facts_)) add(problem);
    for (const std::string& problem : check_photographs(route_, facts_)) add(problem);
    for (const std::string& problem : check_fence(file_, route_, facts_)) add(problem);
    return std::move(route_);
  }

 private:
  void add(const std::string& problem) { route_.problems.push_back(problem); }

  void add_problem(const MissionItem& item, const std::string& what) {
    add(item_label(item) + " (command " + std::to_string(item.command) + ") " + what);
  }

  void step(const MissionItem& item) {
    const CommandRow* row = find_command(item.command);
    if (row == nullptr) {
      return add_problem(item, "is an unsupported command; remove it");
    }
    if (has_landed_) return add_problem(item, "occurs after the landing");
    if (!item.auto_continue)
      add_problem(item, "does not continue to the next item (autocontinue is 0)");
    if (!is_supported(*row)) {
      return add_problem(item, std::string("is a ") + row->name + ", which " + autopilot_name() +
                                   " does not support");
    }
    if (row->meaning == Meaning::rejected) {
      return add_problem(item, std::string("is a ") + row->name + ": " + row->reason);
    }
    if (check_frame(item, *row)) execute(item, *row);
  }

  bool is_supported(const CommandRow& row) const {
    return row.supported_by == SupportedBy::both ||
           (row.supported_by == SupportedBy::ardupilot) == (autopilot_ == AutopilotType::ardupilot);
  }
  std::string autopilot_name() const {
    return autopilot_ == AutopilotType::px4 ? "PX4" : "ArduPilot";
  }

  bool check_frame(const MissionItem& item, const CommandRow& row) {
    if (has_position(row.meaning)) {
      if (is_above_sea(item) || is_above_home(item)) return check_position(item, row);
      add_problem(item, "has frame " + std::to_string(item.frame) +
                            ", which is not supported; use 3 (above home) or 0 (AMSL)");
      return false;
    }
    if (autopilot_ != AutopilotType::px4 || item.frame == frame::mission) return true;
    add_problem(item,
                "has frame " + std::to_string(item.frame) + "; PX4 accepts it in frame 2 only");
    return false;
  }

  bool check_position(const MissionItem& item, const CommandRow& row) {
    const bool is_nowhere = !has_coordinates(item) && !uses_current_position(row);
    if (is_nowhere)
      add_problem(item, "has no position: latitude and longitude 0 mean the previous position");
    const bool is_without_height = row.meaning == Meaning::fly_to && item.params[6] == 0.0;
    if (is_without_height)
      add_problem(item, "has height 0, which ArduPilot interprets as the previous height");
    return !is_nowhere && !is_without_height;
  }

  /// Returns true if the item without position is executed at the current position, as ArduCopter
  /// does for take-off and landing (AP_Mission's default location). The take-off position must be
  /// known from the mission or from the file's home.
  bool uses_current_position(const CommandRow& row) const {
    if (autopilot_ != AutopilotType::ardupilot) return false;
    if (row.meaning == Meaning::take_off) return facts_.is_pad_known || file_.home;
    return row.meaning == Meaning::land;
  }

  void execute(const MissionItem& item, const CommandRow& row) {
    if (!has_taken_off_ && row.meaning != Meaning::take_off && is_motion(row.meaning)) {
      return add_problem(item, "flies before the take-off (22)");
    }
    switch (row.meaning) {
      case Meaning::take_off:
        return take_off(item);
      case Meaning::fly_to:
        return fly_to(item);
      case Meaning::land:
        return land(item);
      case Meaning::wait:
        return wait(item);
      case Meaning::turn:
        return turn(item);
      case Meaning::set_speed:
        return set_speed(item);
      case Meaning::aim_by_mount:
      case Meaning::aim_by_gimbal:
        return aim(item, row.meaning);
      case Meaning::take_photo:
      case Meaning::trigger_photo:
        return photograph(item, row.meaning);
      case Meaning::space_photos:
        return space_photos(item);
      case Meaning::hold_fence:
        if (item.params[0] != 1.0) add_problem(item, "disables the fence");
        return;
      default:
        return;
    }
  }

  static bool is_motion(Meaning meaning) {
    return has_position(meaning) || meaning == Meaning::wait || meaning == Meaning::take_photo ||
           meaning == Meaning::trigger_photo;
  }

  Vector3d position_from_item(const MissionItem& item) const {
    double height = item.params[6];
    height += is_above_sea(item) ? facts_.site.undulation_for(item_label(item) + " (AMSL)")
                                 : frame_.to_geodetic(facts_.pad).height;
    GeodeticPoint position{item.params[4], item.params[5], height};
    if (!has_coordinates(item)) {
      const GeodeticPoint here = current_position();
      position.latitude_deg = here.latitude_deg, position.longitude_deg = here.longitude_deg;
    }
    return frame_.to_local(position);
  }

  /// Returns the current horizontal position: the pad before take-off, otherwise the end of the
  /// last leg.
  GeodeticPoint current_position() const {
    if (has_taken_off_) return frame_.to_geodetic(position_);
    return facts_.is_pad_known || !file_.home ? frame_.to_geodetic(facts_.pad) : *file_.home;
  }

  // Autopilots climb at their current position, so only the height of a take-off item counts.
  void take_off(const MissionItem& item) {
    if (has_taken_off_) return add_problem(item, "takes off again in mid-flight");
    const Vector3d position = position_from_item(item);
    has_taken_off_ = true;
    pad_ = facts_.pad;
    if (!facts_.is_pad_known) pad_.head<2>() = position.head<2>();
    if (const double away = (position - pad_).head<2>().norm(); away > pad_tolerance) {
      add_problem(item, "takes off " + fixed(away, 1) + " m from the mission's take-off point");
    }
    position_ = Vector3d(pad_.x(), pad_.y(), position.z());
    if (position_.z() <= pad_.z())
      add_problem(item, "climbs to a height that is not above the take-off point");
    append_column(route_, {pad_, position_}, {"the take-off point", item_label(item)},
                  facts_.takeoff_climb);
    arrive(item, {{position_, position_}}, true);
  }

  void fly_to(const MissionItem& item) {
    check_default_speed(item);
    const Vector3d target = position_from_item(item);
    fly_straight(target, item);
    const double distance = (target - position_).norm();
    position_ = target;
    hold_ = route_.segments.back().hold = item.params[0];
    const bool stops = hold_ > 0.0 || stops_for_the_next();
    const double radius = compute_radius(item);
    Departure departure{{target, target}};
    if (!stops && autopilot_ == AutopilotType::ardupilot) {
      // Blends two legs from the middle of the first one at the earliest, when the blend before is
      // complete (AP_Math/SCurve.cpp).
      departure = departure_after(route_.segments.back(), 0.5 * distance);
      departure.margin = 0.0;
    } else if (!stops || radius > acceptance_radius) {
      const Vector3d leg = route_.segments.back().to - route_.segments.back().start.to;
      departure = departure_after(route_.segments.back(), autopilot_ == AutopilotType::px4
                                                              ? px4_turn_distance(leg, radius)
                                                              : radius);
    }
    arrive(item, departure, stops && radius <= acceptance_radius);
  }

  void fly_straight(const Vector3d& to, const MissionItem& item) {
    route_.segments.push_back({departure_.start, to, item_label(*last_), item_label(item)});
    route_.segments.back().speed = speed_;
    route_.segments.back().margin = departure_.margin;
    if (photo_spacing_ == 0.0) return;
    if (departure_.start.length() > 0.0) {
      return add_problem(
          item,
          "is reached with the camera trigger active, but the exact start of the leg is unknown");
    }
    append_passes(route_, photo_spacing_,
                  autopilot_ == AutopilotType::ardupilot ? next_yaw_deg_ : item.params[3],
                  pitch_deg_);
  }

  /// Returns the acceptance radius. ArduCopter has one radius for all waypoints, which it observes
  /// at stops. A larger radius in the file is rejected as well, because a different vehicle may use
  /// the file.
  double compute_radius(const MissionItem& item) const {
    const bool counts = item.command == command::waypoint;
    const double radius = counts && std::isfinite(item.params[1]) ? item.params[1] : 0.0;
    return radius > 0.0 || autopilot_ != AutopilotType::px4 ? radius : default_radius_px4;
  }

  /// Returns true if ArduPilot stops at a waypoint without a hold, which it does unless the next
  /// flown item is a waypoint, too.
  bool stops_for_the_next() const {
    if (autopilot_ != AutopilotType::ardupilot) return false;
    for (const MissionItem* item : upcoming_) {
      const CommandRow* row = find_command(item->command);
      if (row == nullptr || row->meaning == Meaning::fly_to) return false;
      if (row->meaning == Meaning::land || row->meaning == Meaning::wait) return true;
    }
    return false;
  }

  void arrive(const MissionItem& item, const Departure& departure, bool is_exact) {
    last_ = &item;
    departure_ = departure;
    is_exact_ = is_exact;
    shoots_ = false;
    // ArduPilot turns the nose to the next waypoint unless a CONDITION_YAW was executed since the
    // last one.
    yaw_deg_ = autopilot_ == AutopilotType::ardupilot ? next_yaw_deg_ : item.params[3];
    next_yaw_deg_ = unspecified;
  }

  // Flies level to the position at the current height, then down. The item's own height is ignored.
  void land(const MissionItem& item) {
    check_default_speed(item);
    has_landed_ = true;
    const Vector3d position = position_from_item(item);
    const Vector3d above(position.x(), position.y(), position_.z());
    fly_straight(above, item);
    const Vector3d ground(position.x(), position.y(), pad_.z());
    append_column(route_, {above, ground}, {item_label(item), "the ground"}, facts_.takeoff_climb);
    if (const double away = (position - pad_).head<2>().norm(); away > pad_tolerance) {
      add_problem(item, "lands " + fixed(away, 1) +
                            " m from the take-off point; the ground there is not " + "verified");
    }
  }

  void wait(const MissionItem& item) {
    const double seconds = item.params[0];
    if (!(seconds > 0.0 && seconds <= longest_wait)) {
      return add_problem(
          item, "waits for " + fixed(seconds, 1) +
                    " s; it must be above 0 and at most 600 (other values set a time of day)");
    }
    if (departure_.start.length() == 0.0) hold_ += seconds;
    if (shoots_) route_.stops.back().hold_after += seconds;
    route_.segments.back().hold += seconds;
  }

  void turn(const MissionItem& item) {
    if (item.params[3] != 0.0) return add_problem(item, "sets a relative yaw instead of a heading");
    if (!(item.params[0] >= 0.0 && item.params[0] <= 360.0)) {
      return add_problem(item, "turns to a heading outside the range 0 to 360 degrees");
    }
    next_yaw_deg_ = item.params[0];
  }

  void set_speed(const MissionItem& item) {
    const double type = item.params[0], speed = item.params[1];
    double limit = facts_.cruise_speed;
    std::string whose = "the mission's cruise speed";
    if (type == 2.0 || type == 3.0) {
      if (!facts_.vehicle) return;
      limit = type == 2.0 ? facts_.vehicle->mode.max_ascent : facts_.vehicle->mode.max_descent;
      whose = "the vehicle's limit";
    } else if (type == 0.0 || type == 1.0) {
      is_speed_set_ = true;
      speed_ = speed;
    } else {
      return add_problem(item, "sets an unsupported speed type; use 0, 1, 2 or 3");
    }
    if (speed > 0.0 && speed <= limit + 1e-3) return;
    add_problem(item, "sets " + fixed(speed, 2) + " m/s; it must be above 0 and at most " + whose +
                          ", " + fixed(limit, 2) + " m/s");
  }

  void check_default_speed(const MissionItem& item) {
    const double speed =
        autopilot_ == AutopilotType::px4 ? default_speed_px4 : default_speed_ardupilot;
    if (is_speed_set_ || speed <= facts_.cruise_speed) return;
    is_speed_set_ = true;  // Reported once.
    add_problem(item, "is flown to at " + autopilot_name() + "'s default of " + fixed(speed, 0) +
                          " m/s, because no previous item sets the speed (178)");
  }

  void aim(const MissionItem& item, Meaning meaning) {
    const auto& p = item.params;
    if (meaning == Meaning::aim_by_mount) {
      if (p[6] != aims_by_angles) return add_problem(item, "must set the gimbal angles (mode 2)");
      if (p[1] != 0.0 || p[2] != 0.0) {
        return add_problem(item, "sets gimbal roll or yaw; only pitch is supported");
      }
    } else if (p[1] != 0.0 && !std::isnan(p[1])) {
      return add_problem(item, "sets gimbal yaw; only pitch is supported");
    }
    pitch_deg_ = p[0];
  }

  void photograph(const MissionItem& item, Meaning meaning) {
    if (meaning == Meaning::take_photo && item.params[2] != 1.0) {
      return add_problem(item, "takes " + fixed(item.params[2], 0) +
                                   " images; exactly one per command is supported");
    }
    if (meaning == Meaning::trigger_photo && item.params[4] != 1.0) return;  // Focus or zoom.
    if (!is_exact_) return add_problem(item, "captures an image where the vehicle does not stop");
    if (std::exchange(shoots_, true)) {
      ++route_.stops.back().captures;
      return;
    }
    route_.stops.push_back({position_, item_label(*last_), hold_, yaw_deg_, pitch_deg_, 1});
  }

  /// Sensors that measure depth have no such trigger.
  void space_photos(const MissionItem& item) {
    if (!facts_.photo) return;
    const double spacing = item.params[0];
    if (spacing != 0.0 && !(spacing >= min_photo_spacing)) {
      return add_problem(item, "triggers the camera every " + fixed(spacing, 2) +
                                   " m; it must be 0 or at least 0.1 m");
    }
    if (item.params[2] != 0.0 && spacing > 0.0) {
      return add_problem(item, "captures an image immediately; set parameter 3 to 0");
    }
    photo_spacing_ = spacing;
  }

  const MavlinkMission& file_;
  const AutopilotType autopilot_;
  const FlightFacts& facts_;
  LocalFrame frame_;
  std::vector<MissionItem> items_;
  std::deque<const MissionItem*> upcoming_;  ///< In flight order.
  InterpretedRoute route_;

  bool has_taken_off_ = false, has_landed_ = false;
  bool is_speed_set_ = false;
  bool is_exact_ = false;              ///< True if the vehicle comes to rest in `position_`.
  bool shoots_ = false;                ///< True if the last stop is the current one.
  const MissionItem* last_ = nullptr;  ///< Last item flown to.
  Vector3d pad_ = Vector3d::Zero();
  Vector3d position_ = Vector3d::Zero();
  /// Possible start positions of the next leg.
  Departure departure_{{Vector3d::Zero(), Vector3d::Zero()}};
  double hold_ = 0.0;
  double photo_spacing_ = 0.0;  ///< of the camera's trigger; zero: none
  double speed_ = unspecified;
  double yaw_deg_ = unspecified, next_yaw_deg_ = unspecified, pitch_deg_ = unspecified;
};

}  // namespace

InterpretedRoute interpret(const MavlinkMission& file, const FlightFacts& facts) {
  // The vehicle's own autopilot. DJI vehicles do not fly such files.
  std::optional<AutopilotType> supported_by;
  if (facts.vehicle && facts.vehicle->autopilot != AutopilotType::dji)
    supported_by = facts.vehicle->autopilot;
  const AutopilotType autopilot =
      file.autopilot.value_or(supported_by.value_or(AutopilotType::px4));
  InterpretedRoute route = MissionFlight(file, autopilot, facts).fly();
  if (!file.autopilot && !supported_by) {
    route.problems.insert(route.problems.begin(), "the file does not specify its autopilot");
  }
  if (supported_by && *supported_by != autopilot) {
    route.problems.insert(route.problems.begin(),
                          std::string("the file is written for ") +
                              (autopilot == AutopilotType::px4 ? "PX4" : "ArduPilot") +
                              "; vehicle \"" + facts.vehicle->name + "\" has another autopilot");
  }
  return route;
}

}  // namespace skycap::flight
