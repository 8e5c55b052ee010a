#include "flight/export/trajectory_file.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double half_pi = std::numbers::pi / 2.0;
constexpr std::string_view csv_header = "t,x,y,z,vx,vy,vz,ax,ay,az,yaw,yaw_rate,gimbal_pitch,shot";
constexpr std::string_view enu_comment =
    "# frame: ENU (x east, y north, z up), yaw counter-clockwise from east, metres, radians";
constexpr std::string_view ned_comment =
    "# frame: NED (x north, y east, z down), yaw clockwise from north, metres, radians";
constexpr std::string_view tum_comment =
    "# timestamp tx ty tz qx qy qz qw; world frame ENU, camera optical (z forward, x right, y "
    "down)";

// Converts between ENU and NED.
Vector3d swapped(const Vector3d& v) { return {v.y(), v.x(), -v.z()}; }

/// Returns the shorter rotation between two headings.
double turn(double from, double to) { return std::remainder(to - from, 2.0 * std::numbers::pi); }

class TrajectorySampler {
 public:
  TrajectorySampler(const FlightPlan& plan, double interval)
      : plan_(plan), motion_(plan.vehicle, plan.conditions), interval_(interval) {}

  std::vector<TimedState> sample() {
    const std::vector<StopTime> times = stop_times(plan_);
    aim_at_first_capture_point();
    // The autopilot flies the climb from the pad, whose clearance is verified separately.
    Vector3d from = plan_.waypoints.front().position;
    double left = times.front().arrival;
    for (std::size_t i = 0; i < plan_.waypoints.size(); ++i) {
      add_leg(from, plan_.waypoints[i], left, times[i].aimed);
      add_stop(plan_.waypoints[i], times[i]);
      from = plan_.waypoints[i].position;
      left = times[i].departure;
    }
    return std::move(states_);
  }

 private:
  void aim_at_first_capture_point() {
    for (const auto* waypoints : {&plan_.passed, &plan_.waypoints}) {
      for (const Waypoint& waypoint : *waypoints) {
        if (!waypoint.is_capture_point) continue;
        yaw_ = waypoint.yaw, pitch_ = waypoint.pitch;
        return;
      }
    }
  }

  /// Adds states at the regular interval and at the images.
  void add_fly_through(const FlyThrough& fly_through, double start, double end) {
    std::vector<double> moments;
    const auto first = static_cast<std::size_t>(std::ceil(start / interval_));
    for (std::size_t k = first; static_cast<double>(k) * interval_ < end; ++k) {
      moments.push_back(static_cast<double>(k) * interval_);
    }
    auto view = fly_through.views.begin();
    const auto add_views = [&](double until) {
      for (; view != fly_through.views.end() && start + view->moment <= until; ++view) {
        add_passing(fly_through, start, start + view->moment);
        states_.back().is_capture =
            plan_.passed[static_cast<std::size_t>(view - fly_through.views.begin())].captures > 0;
      }
    };
    for (const double moment : moments) {
      add_views(moment);
      if (states_.empty() || !states_.back().is_capture || moment - states_.back().time >= 1e-6) {
        add_passing(fly_through, start, moment);
      }
    }
    add_views(end);
    yaw_ = fly_through.views.back().aim.yaw, pitch_ = fly_through.views.back().aim.pitch;
  }

  void add_passing(const FlyThrough& fly_through, double start, double time) {
    constexpr double step = 1e-4;  // Time step of the difference for the yaw rate [s].
    const CurveState moved = state_at(fly_through.curve, time - start);
    const Aim aim = fly_through.aim_at(time - start);
    const double next_yaw = fly_through.aim_at(time - start + step).yaw;
    add({time, moved.position, moved.velocity, moved.acceleration, aim.yaw,
         turn(aim.yaw, next_yaw) / step, aim.pitch, false});
  }

  CurveState straight_state(const Vector3d& from, const Waypoint& to, double time) const {
    const double distance = (to.position - from).norm();
    if (distance == 0.0) return {from};
    const Vector3d direction = (to.position - from) / distance;
    const MotionState along =
        rest_to_rest_state(distance, motion_.leg_speed(direction),
                           motion_.leg_acceleration(direction), plan_.vehicle.mode.jerk, time);
    return {from + along.distance * direction, along.speed * direction,
            along.acceleration * direction};
  }

  void add_leg(const Vector3d& from, const Waypoint& to, double start, double end) {
    if (to.fly_through) {
      add_fly_through(*to.fly_through, start, end);
      return;
    }
    const double target_yaw = to.is_capture_point ? to.yaw : yaw_;
    const double target_pitch = to.is_capture_point ? to.pitch : pitch_;
    const double duration = end - start;
    const auto first = static_cast<std::size_t>(std::ceil(start / interval_));
    for (std::size_t k = first; static_cast<double>(k) * interval_ < end; ++k) {
      TimedState state;
      state.time = static_cast<double>(k) * interval_;
      const CurveState moved = to.curve.empty() ? straight_state(from, to, state.time - start)
                                                : state_at(to.curve, state.time - start);
      state.position = moved.position;
      state.velocity = moved.velocity;
      state.acceleration = moved.acceleration;
      const double share = duration > 0.0 ? (state.time - start) / duration : 1.0;
      state.yaw = yaw_ + share * turn(yaw_, target_yaw);
      state.yaw_rate = duration > 0.0 ? turn(yaw_, target_yaw) / duration : 0.0;
      state.pitch = pitch_ + share * (target_pitch - pitch_);
      add(state);
    }
    yaw_ = target_yaw, pitch_ = target_pitch;
  }

  void add_stop(const Waypoint& waypoint, const StopTime& times) {
    TimedState state{
        times.aimed, waypoint.position, Vector3d::Zero(), Vector3d::Zero(), yaw_, 0.0, pitch_,
        false};
    add(state);
    state.time = times.capture;
    state.is_capture = waypoint.captures > 0;
    add(state);
    if (!(times.departure > times.capture)) return;
    state.time = times.departure;
    state.is_capture = false;
    add(state);
  }

  /// Keeps times strictly ascending. A regular sample at the end of a stop is replaced.
  void add(const TimedState& state) {
    if (!states_.empty() && state.time - states_.back().time < 1e-6) {
      states_.back() = state;
    } else {
      states_.push_back(state);
    }
  }

  const FlightPlan& plan_;
  Motion motion_;
  double interval_;
  double yaw_ = 0.0, pitch_ = 0.0;
  std::vector<TimedState> states_;
};

bool is_comment(const std::string& line) {
  return geometry::trimmed(line).empty() || geometry::trimmed(line).front() == '#';
}

/// Parses rows of numbers. Problems include the line number.
std::vector<std::vector<double>> parse_rows(const std::vector<std::string>& lines,
                                            std::size_t first, char separator, std::size_t count,
                                            Problems& problems) {
  std::vector<std::vector<double>> rows;
  double last_time = -std::numeric_limits<double>::infinity();
  for (std::size_t i = first; i < lines.size(); ++i) {
    if (is_comment(lines[i])) continue;
    const std::string who = "line " + std::to_string(i + 1) + " ";
    const std::optional<std::vector<double>> row =
        to_numbers(separator == ' ' ? geometry::split_words(lines[i]) : split(lines[i], separator),
                   who, problems);
    if (!row) return rows;
    if (row->size() != count) {
      problems.push_back(who + "has " + std::to_string(row->size()) + " numbers; it must have " +
                         std::to_string(count));
      return rows;
    }
    if (row->front() <= last_time)
      problems.push_back(who + "has a time that is not later than that of the previous line");
    last_time = row->front();
    rows.push_back(*row);
  }
  if (rows.empty()) problems.emplace_back("no row");
  return rows;
}

std::vector<std::vector<double>> csv_rows(const std::string& text, Frame& frame,
                                          Problems& problems) {
  const std::vector<std::string> lines = split_lines(text);
  if (lines.size() < 2 || (lines[0] != enu_comment && lines[0] != ned_comment)) {
    problems.emplace_back("line 1 must specify the frame, ENU or NED");
    return {};
  }
  frame = lines[0] == enu_comment ? Frame::enu : Frame::ned;
  if (lines[1] != csv_header) {
    problems.push_back("line 2 must be \"" + std::string(csv_header) + "\"");
    return {};
  }
  return parse_rows(lines, 2, ',', 14, problems);
}

std::vector<std::vector<double>> tum_rows(const std::string& text, Problems& problems) {
  auto rows = parse_rows(split_lines(text), 0, ' ', 8, problems);
  for (const auto& row : rows) {
    const double norm = Eigen::Vector4d(row[4], row[5], row[6], row[7]).norm();
    if (std::abs(norm - 1.0) > 1e-6) {
      problems.push_back("the quaternion at " + fixed(row[0], 6) + " s has length " +
                         fixed(norm, 6) + "; it must be 1");
    }
  }
  return rows;
}

}  // namespace

std::vector<TimedState> trajectory(const FlightPlan& plan, double interval) {
  if (!(interval > 0.0)) {
    throw Error(ErrorKind::bad_config, "the trajectory's interval is " + std::to_string(interval) +
                                           " s; it must be positive");
  }
  return TrajectorySampler(plan, interval).sample();
}

std::string write_trajectory_csv(const std::vector<TimedState>& states, Frame frame) {
  const bool is_ned = frame == Frame::ned;
  std::string text =
      std::string(is_ned ? ned_comment : enu_comment) + "\n" + std::string(csv_header) + "\n";
  for (const TimedState& state : states) {
    text += fixed(state.time, 6);
    for (const Vector3d& vector : {state.position, state.velocity, state.acceleration}) {
      const Vector3d written = is_ned ? swapped(vector) : vector;
      for (int axis = 0; axis < 3; ++axis) text += "," + fixed(written[axis], 6);
    }
    const double yaw = is_ned ? state.yaw : std::remainder(half_pi - state.yaw, 4.0 * half_pi);
    text += "," + fixed(yaw, 6) + "," + fixed(is_ned ? state.yaw_rate : -state.yaw_rate, 6) + "," +
            fixed(state.pitch, 6) + (state.is_capture ? ",1\n" : ",0\n");
  }
  return text;
}

Problems validate_trajectory_csv(const std::string& text) {
  Problems problems;
  Frame frame = Frame::enu;
  csv_rows(text, frame, problems);
  return problems;
}

std::vector<TimedState> read_trajectory_csv(const std::string& text) {
  Problems problems;
  Frame frame = Frame::enu;
  const auto rows = csv_rows(text, frame, problems);
  throw_first(problems, "invalid trajectory file");
  const bool is_ned = frame == Frame::ned;
  std::vector<TimedState> states;
  for (const auto& row : rows) {
    const auto vector = [&](std::size_t i) -> Vector3d {
      const Vector3d read(row[i], row[i + 1], row[i + 2]);
      return is_ned ? swapped(read) : read;
    };
    states.push_back({row[0], vector(1), vector(4), vector(7), is_ned ? row[10] : half_pi - row[10],
                      is_ned ? row[11] : -row[11], row[12], row[13] != 0.0});
  }
  return states;
}

std::vector<TimedPose> camera_poses(const std::vector<TimedState>& states) {
  std::vector<TimedPose> poses;
  poses.reserve(states.size());
  for (const TimedState& state : states) {
    const Vector3d direction(std::sin(state.yaw) * std::cos(state.pitch),
                             std::cos(state.yaw) * std::cos(state.pitch), std::sin(state.pitch));
    poses.push_back({state.time, geometry::camera_pose({state.position, direction})});
  }
  return poses;
}

std::string write_tum(const std::vector<TimedPose>& poses) {
  std::string text = std::string(tum_comment) + "\n";
  for (const TimedPose& pose : poses) {
    const Eigen::Quaterniond q(pose.world_from_camera.linear());
    const Vector3d p = pose.world_from_camera.translation();
    text += fixed(pose.time, 6);
    for (const double number : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) {
      text += " " + fixed(number, 9);
    }
    text += "\n";
  }
  return text;
}

Problems validate_tum(const std::string& text) {
  Problems problems;
  tum_rows(text, problems);
  return problems;
}

std::vector<TimedPose> read_tum(const std::string& text) {
  Problems problems;
  const auto rows = tum_rows(text, problems);
  throw_first(problems, "invalid TUM trajectory");
  std::vector<TimedPose> poses;
  for (const auto& row : rows) {
    TimedPose pose{row[0]};
    pose.world_from_camera.translation() = Vector3d(row[1], row[2], row[3]);
    pose.world_from_camera.linear() =
        Eigen::Quaterniond(row[7], row[4], row[5], row[6]).normalized().toRotationMatrix();
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace skycap::flight
