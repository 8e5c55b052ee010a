#include "flight/export/mission_items.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/angle.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using geometry::degrees_per_radian;

bool is_navigation(int c) {
  return c == command::waypoint || c == command::takeoff || c == command::land ||
         c == command::return_to_launch || c == command::delay || c == command::loiter_time;
}
bool has_position(int c) {
  return c == command::waypoint || c == command::loiter_time || c == command::takeoff ||
         c == command::land;
}
bool is_gimbal(int c) { return c == command::mount_control || c == command::gimbal_pitch_yaw; }
bool is_capture_command(int c) {
  return c == command::start_capture || c == command::digicam_control;
}

class ItemWriter {
 public:
  explicit ItemWriter(const FlightPlan& plan)
      : plan_(plan),
        times_(stop_times(plan)),
        recording_(recorded_stretch(plan)),
        local_(plan.site.origin),
        pad_(local_.to_geodetic(plan.pad)),
        speed_(plan.conditions.cruise_speed) {}

  std::vector<MissionItem> write() {
    const Waypoint& above_pad = plan_.waypoints.front();
    add_position(command::takeoff, {0, 0, 0, unspecified}, above_pad.position);
    add_speeds();
    for (std::size_t i = 1; i < plan_.waypoints.size(); ++i) {
      set_speed(leg_speed(plan_, i));
      plan_.waypoints[i].is_capture_point ? add_capture_point(i) : add_stop(i, unspecified);
      if (recording_.is_empty()) continue;
      if (i == recording_.first) add(command::start_video, {0, 0, 0, 0, 0, 0, 0});
      if (i == recording_.last) add(command::stop_video, {0, 0, 0, 0, 0, 0, 0});
    }
    set_speed(plan_.conditions.cruise_speed);
    add_position(command::land, {0, 0, 0, unspecified}, plan_.pad);
    for (std::size_t i = 0; i < items_.size(); ++i) items_[i].number = i + 1;
    return std::move(items_);
  }

 private:
  bool is_ardupilot() const { return plan_.vehicle.autopilot == AutopilotType::ardupilot; }

  void add(int number, const std::array<double, 7>& params) {
    items_.push_back({number, frame::mission, params});
  }

  void add_position(int number, const std::array<double, 4>& params,
                    const Eigen::Vector3d& position) {
    const GeodeticPoint geodetic = local_.to_geodetic(position);
    items_.push_back(
        {number,
         frame::relative,
         {params[0], params[1], params[2], params[3], rounded_degrees(geodetic.latitude_deg),
          rounded_degrees(geodetic.longitude_deg),
          std::round((geodetic.height - pad_.height) * 1e3) / 1e3}});
  }

  /// Adds all speeds that times and tracking depend on, independent of the vehicle's settings. PX4
  /// ignores vertical speeds in missions.
  void add_speeds() {
    add(command::change_speed, {1, plan_.conditions.cruise_speed, -1, 0, 0, 0, 0});
    if (!is_ardupilot()) return;
    add(command::change_speed, {2, plan_.vehicle.mode.max_ascent, -1, 0, 0, 0, 0});
    add(command::change_speed, {3, plan_.vehicle.mode.max_descent, -1, 0, 0, 0, 0});
  }

  void set_speed(double speed) {
    if (speed == speed_) return;
    speed_ = speed;
    add(command::change_speed, {1, speed, -1, 0, 0, 0, 0});
  }

  /// Returns the rate of yaw that turns the vehicle evenly during the leg to a waypoint, or 0: the
  /// autopilot's own rate [degrees/s].
  double even_yaw_rate(std::size_t i) const {
    const Waypoint& to = plan_.waypoints[i];
    const Waypoint& from = plan_.waypoints[i - 1];
    if (to.leg_time <= 0.0 || !from.is_capture_point) return 0.0;
    constexpr double min_rate = 1.0;  // Whole degrees per second; 0 is the autopilot's own.
    const double turn = std::remainder(to.yaw - from.yaw, 2.0 * std::numbers::pi);
    return std::max(min_rate, std::ceil(degrees_per_radian * std::abs(turn) / to.leg_time));
  }

  void add_delay(double seconds) {
    if (seconds > 0.0) add(command::delay, {seconds, -1, -1, -1, 0, 0, 0});
  }

  /// Adds the position and the wait before the captures, if any. ArduPilot rounds a waypoint's hold
  /// to whole seconds but not a delay, which also turns the previous waypoint into a stop.
  void add_stop(std::size_t i, double yaw_deg) {
    const double wait = std::round((times_[i].capture - times_[i].arrival) * 1e3) / 1e3;
    const bool is_passed = plan_.waypoints[i].is_passed && !is_ardupilot();
    const double radius = is_passed ? turn_radius(plan_, i) : acceptance_radius;
    add_position(command::waypoint, {is_ardupilot() ? 0.0 : wait, radius, 0, yaw_deg},
                 plan_.waypoints[i].position);
    if (is_ardupilot()) add_delay(wait);
  }

  // Adds the items of a waypoint with captures.
  //
  // ArduPilot starts "do" items when the previous item is complete, and continues to fly. Gimbal
  // and yaw therefore rotate en route. The gimbal comes first, because items after a CONDITION_YAW
  // wait until the vehicle has rotated. ArduPilot obeys CONDITION_YAW and ignores the waypoint's
  // yaw. PX4 obeys the latter and rejects missions with a CONDITION_YAW. The delay after the
  // captures keeps the vehicle in position until the shutter has closed.
  void add_capture_point(std::size_t i) {
    const Waypoint& capture_point = plan_.waypoints[i];
    const double yaw_deg =
        std::fmod(std::round(capture_point.yaw * degrees_per_radian * 1e4) / 1e4, 360.0);
    const double pitch_deg = std::round(capture_point.pitch * degrees_per_radian * 1e4) / 1e4;
    if (capture_point.run) add_trigger(capture_point.run->spacing, capture_point.run->speed);
    add(command::mount_control, {pitch_deg, 0, 0, 0, 0, 0, 2});  // 2: aim by these angles.
    if (is_ardupilot()) add(command::condition_yaw, {yaw_deg, even_yaw_rate(i), 0, 0, 0, 0, 0});
    add_stop(i, is_ardupilot() ? unspecified : yaw_deg);
    if (capture_point.run) add_trigger(0.0, plan_.conditions.cruise_speed);
    for (int capture = 0; capture < capture_point.captures; ++capture) add_shot();
    add_delay(capture_point.hold_after);
  }

  /// Of a photo camera ArduPilot triggers the shutter, which all of its camera drivers can do;
  /// IMAGE_START_CAPTURE is for cameras that speak MAVLink.
  void add_shot() {
    if (plan_.photo && is_ardupilot()) {
      add(command::digicam_control, {0, 0, 0, 0, 1, 0, 0});
    } else {
      add(command::start_capture, {0, 0, 1, static_cast<double>(++captures_), 0, 0, 0});
    }
  }

  /// Photos at that distance from here on, none at once; 0 ends them.
  void add_trigger(double spacing, double speed) {
    add(command::change_speed, {1, speed, -1, 0, 0, 0, 0});
    add(command::camera_trigger_distance, {std::round(spacing * 1e3) / 1e3, 0, 0, 0, 0, 0, 0});
  }

  const FlightPlan& plan_;
  std::vector<StopTime> times_;
  Recording recording_;
  LocalFrame local_;
  GeodeticPoint pad_;
  double speed_;  ///< That the items so far set [m/s].
  int captures_ = 0;
  std::vector<MissionItem> items_;
};

class ItemChecker {
 public:
  ItemChecker(const std::vector<MissionItem>& items, std::optional<AutopilotType> autopilot)
      : items_(items), autopilot_(autopilot) {}

  Problems check() {
    for (std::size_t i = 0; i < items_.size(); ++i) check_item(i);
    check_ends();
    check_captures();
    return std::move(problems_);
  }

 private:
  void add_problem(std::size_t i, const std::string& what) {
    problems_.push_back(item_label(items_[i]) + " (command " + std::to_string(items_[i].command) +
                        ") " + what);
  }

  void check_item(std::size_t i) {
    const MissionItem& item = items_[i];
    const bool is_known_frame = is_above_sea(item) || item.frame == frame::mission ||
                                is_above_home(item) || item.frame == frame::terrain;
    if (!is_known_frame)
      add_problem(i, "has frame " + std::to_string(item.frame) + "; use 0, 2, 3, 5, 6 or 10");
    if (has_position(item.command)) check_position(i);
    if (item.command == command::jump) {
      const double target = item.params[0];
      if (!(target >= static_cast<double>(items_.front().number) &&
            target <= static_cast<double>(items_.back().number))) {
        add_problem(i, "jumps to item " + fixed(target, 0) + ", which does not exist");
      }
    }
    if (autopilot_ == AutopilotType::px4) check_for_px4(i);
    if (autopilot_ == AutopilotType::ardupilot) check_for_ardupilot(i);
  }

  void check_position(std::size_t i) {
    const MissionItem& item = items_[i];
    if (item.frame == frame::mission)
      add_problem(i, "has a position, but frame 2 does not allow one");
    if (!(std::abs(item.params[4]) <= 90.0))
      add_problem(i, "has a latitude outside the range -90 to 90 degrees");
    if (!(std::abs(item.params[5]) <= 180.0))
      add_problem(i, "has a longitude outside the range -180 to 180 degrees");
    if (!(item.params[6] >= -500.0 && item.params[6] <= 10000.0)) {
      add_problem(i, "has a height outside the range -500 to 10000 m");
    }
    if (item.command == command::waypoint && !(item.params[0] >= 0.0)) {
      add_problem(i, "has a negative hold time");
    }
  }

  void check_for_px4(std::size_t i) {
    if (items_[i].command == command::condition_yaw) {
      add_problem(i, "is a CONDITION_YAW; PX4 rejects missions with this command");
    }
    if (items_[i].frame == frame::terrain)
      add_problem(i, "has frame 10, which PX4 does not support");
  }

  void check_for_ardupilot(std::size_t i) {
    const MissionItem& item = items_[i];
    if (item.command == command::waypoint && item.params[0] != std::floor(item.params[0])) {
      add_problem(
          i, "holds for " + fixed(item.params[0], 2) + " s; ArduPilot stores whole seconds only");
    }
    for (std::size_t p = 0; p < item.params.size(); ++p) {
      if (std::isnan(item.params[p]) && !(p == 3 && has_position(item.command))) {
        add_problem(i, "has no parameter " + std::to_string(p + 1) + ", which ArduPilot rejects");
      }
    }
    if (item.command == command::gimbal_pitch_yaw && item.params[0] != std::round(item.params[0])) {
      add_problem(i,
                  "sets an angle with a fraction of a degree, which ArduPilot discards; use "
                  "DO_MOUNT_CONTROL");
    }
  }

  void check_ends() {
    std::vector<std::size_t> navigation;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      if (is_navigation(items_[i].command)) navigation.push_back(i);
    }
    if (navigation.empty()) {
      problems_.emplace_back("the mission contains no navigation item");
      return;
    }
    if (items_[navigation.front()].command != command::takeoff) {
      add_problem(navigation.front(),
                  "is the first item; a mission must begin with a take-off (22)");
    }
    const int last = items_[navigation.back()].command;
    if (last != command::land && last != command::return_to_launch) {
      add_problem(navigation.back(),
                  "is the last item; a mission must end with a landing (21) or return (20)");
    }
  }

  /// Reports captures without a gimbal command since the last position: the camera would keep its
  /// previous aim.
  void check_captures() {
    bool has_aimed = false;
    std::optional<std::size_t> geodetic;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const int c = items_[i].command;
      if (has_position(c)) {
        if (geodetic) has_aimed = has_aimed && aimed_after(*geodetic, i);
        geodetic = i;
      }
      if (is_gimbal(c)) has_aimed = true;
      if (is_capture_command(c) && !has_aimed)
        add_problem(i, "captures an image without a gimbal command for its position");
    }
  }
  bool aimed_after(std::size_t from, std::size_t to) const {
    return std::any_of(items_.begin() + static_cast<std::ptrdiff_t>(from),
                       items_.begin() + static_cast<std::ptrdiff_t>(to),
                       [](const MissionItem& item) { return is_gimbal(item.command); });
  }

  const std::vector<MissionItem>& items_;
  std::optional<AutopilotType> autopilot_;
  Problems problems_;
};

}  // namespace

std::string item_label(const MissionItem& item) { return "item " + std::to_string(item.number); }

bool is_above_sea(const MissionItem& item) {
  return item.frame == frame::global || item.frame == frame::global_int;
}

bool is_above_home(const MissionItem& item) {
  return item.frame == frame::relative || item.frame == frame::relative_int;
}

bool has_coordinates(const MissionItem& item) {
  return item.params[4] != 0.0 || item.params[5] != 0.0;
}

std::vector<MissionItem> mission_items(const FlightPlan& plan) {
  if (plan.vehicle.autopilot == AutopilotType::dji) {
    throw Error(ErrorKind::bad_config,
                "vehicle \"" + plan.vehicle.name +
                    "\" does not support MAVLink missions; use --format kmz");
  }
  std::vector<MissionItem> items = ItemWriter(plan).write();
  if (items.size() > static_cast<std::size_t>(plan.vehicle.max_waypoints)) {
    throw Error(ErrorKind::bad_config, "\"" + plan.name + "\" has " + std::to_string(items.size()) +
                                           " mission items; vehicle \"" + plan.vehicle.name +
                                           "\" accepts " +
                                           std::to_string(plan.vehicle.max_waypoints));
  }
  return items;
}

Problems check_items(const std::vector<MissionItem>& items,
                     std::optional<AutopilotType> autopilot) {
  return ItemChecker(items, autopilot).check();
}

std::vector<MissionItem> as_stored(std::vector<MissionItem> items, AutopilotType autopilot) {
  for (MissionItem& item : items) {
    if (!has_position(item.command)) continue;
    for (const std::size_t p : {4U, 5U}) item.params[p] = std::round(item.params[p] * 1e7) / 1e7;
    if (autopilot == AutopilotType::ardupilot) {
      item.params[0] = std::floor(item.params[0]);
      item.params[6] = std::trunc(item.params[6] * 100.0) / 100.0;
    } else {
      item.params[6] = static_cast<double>(static_cast<float>(item.params[6]));
    }
  }
  return items;
}

RouteFile make_route(const std::vector<MissionItem>& items) {
  RouteFile route;
  double yaw_deg = unspecified, pitch_deg = unspecified;
  for (const MissionItem& item : items) {
    if (item.command == command::condition_yaw) yaw_deg = item.params[0];
    if (is_gimbal(item.command)) pitch_deg = item.params[0];
    if (is_capture_command(item.command) && !route.points.empty()) ++route.points.back().captures;
    if (item.command == command::delay && !route.points.empty()) {
      route.points.back().hold += std::max(0.0, item.params[0]);
    }
    // The landing is vertical from the last waypoint, so the pad itself needs no clearance. Items
    // without a position are executed at the current position.
    if (!has_position(item.command) || item.command == command::land || !has_coordinates(item))
      continue;
    FilePoint point{item.params[4], item.params[5], item.params[6]};
    point.datum = is_above_sea(item) ? HeightDatum::mean_sea_level : HeightDatum::takeoff;
    point.yaw_deg = std::isnan(item.params[3]) ? yaw_deg : item.params[3];
    point.pitch_deg = pitch_deg;
    point.hold = item.command == command::takeoff ? 0.0 : item.params[0];
    route.points.push_back(point);
  }
  return route;
}

}  // namespace skycap::flight
