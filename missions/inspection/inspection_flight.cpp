#include "missions/inspection/inspection_flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "flight/clearance/segment_distance.h"
#include "flight/export/flight_plan.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/wizard/takeoff_point.h"

namespace skycap::missions::inspection {
namespace {

using Eigen::Vector3d;
using survey::inspection::FlightSample;
using survey::inspection::sight_rules;

constexpr double max_sag = 0.25 * flown_deviation;
constexpr double max_aim_error = 5.0 * geometry::radians_per_degree;
/// Legs are shortened for the aim of the camera to this length at least [m].
constexpr double min_aim_length = 0.5;

/// Returns the heading of a yaw angle, clockwise from north [rad].
double heading(double yaw) { return 0.5 * std::numbers::pi - yaw; }

double distance(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  return std::sqrt(flight::nearest(flight::Segment{from, to}, point).squared_distance);
}

/// Returns true if a straight leg with an even rotation follows the samples [begin, end].
bool is_followed(std::span<const FlightSample> flight, std::size_t begin, std::size_t end) {
  const FlightSample &from = flight[begin], &to = flight[end];
  const bool checks_aim = (to.position - from.position).norm() > min_aim_length;
  for (std::size_t i = begin + 1; i < end; ++i) {
    if (distance(flight[i].position, from.position, to.position) > max_sag) return false;
    if (!checks_aim) continue;
    const double share = (flight[i].time - from.time) / (to.time - from.time);
    const double yaw = from.yaw + share * (to.yaw - from.yaw);
    const double pitch = from.pitch + share * (to.pitch - from.pitch);
    if (std::abs(flight[i].yaw - yaw) > max_aim_error) return false;
    if (std::abs(flight[i].pitch - pitch) > max_aim_error) return false;
  }
  return true;
}

flight::CapturePoint make_waypoint(const FlightSample& sample, std::size_t index, double time) {
  flight::CapturePoint point;
  point.view.position = sample.position;
  point.view.direction = flight::compute_direction({heading(sample.yaw), sample.pitch});
  point.hold = point.hold_after = 0.0;
  point.captures = 0;
  point.view_index = static_cast<std::uint32_t>(index);
  point.is_passed = true;
  point.leg_time = time;
  return point;
}

/// Distance that corners of a plan are cut by, and that legs after them start beside their lines
/// [m].
double corner_deviation(const flight::FlightPlan& plan) {
  double deviation = 0.0;
  for (std::size_t i = 1; i + 1 < plan.waypoints.size(); ++i) {
    if (!plan.waypoints[i].is_passed) continue;
    const Vector3d in = plan.waypoints[i].position - plan.waypoints[i - 1].position;
    const Vector3d out = plan.waypoints[i + 1].position - plan.waypoints[i].position;
    const double before = turn_distance(plan, i);
    const bool blends = plan.vehicle.autopilot == flight::AutopilotType::ardupilot;
    const double after = blends ? 0.5 * out.norm() : before;
    // The curve is inside the triangle of both distances. A point at s and t along its sides is
    // min(s, t) sin(angle) from the nearer one at most, and s / before + t / after <= 1.
    const double angle = std::atan2(in.cross(out).norm(), in.dot(out));
    const double sine = angle < 0.5 * std::numbers::pi ? std::sin(angle) : 1.0;
    double cut = before * after / (before + after) * sine;
    if (!blends) cut += before * sine * std::min(1.0, before / out.norm());
    deviation = std::max(deviation, cut);
  }
  return deviation;
}

/// Largest distance of the samples from the legs between waypoints [m].
double sag(std::span<const FlightSample> flight,
           const std::vector<flight::CapturePoint>& waypoints) {
  double largest = 0.0;
  std::size_t leg = 1;
  double time = 0.0;
  for (const FlightSample& sample : flight) {
    while (leg + 1 < waypoints.size() && sample.time > time + waypoints[leg].leg_time + 1e-9) {
      time += waypoints[leg++].leg_time;
    }
    largest = std::max(largest, distance(sample.position, waypoints[leg - 1].view.position,
                                         waypoints[leg].view.position));
  }
  return largest;
}

/// Camera along a leg: DJI aircraft turn heading and gimbal evenly. ArduPilot turns the heading
/// evenly and the gimbal at once, PX4 both at once.
class FlownAim {
 public:
  FlownAim(const flight::Vehicle& vehicle, const flight::Waypoint& first)
      : vehicle_(vehicle), yaw_(first.yaw), pitch_(first.pitch) {}

  /// Moves the aim on for `step` [s]; `left` is the time until the waypoint is reached.
  void advance(const flight::Waypoint& to, double step, double left) {
    const double turn = std::remainder(to.yaw - yaw_, 2.0 * std::numbers::pi);
    const double tilt = to.pitch - pitch_;
    const double even = left > step ? step / left : 1.0;
    const bool turns_evenly = vehicle_.autopilot != flight::AutopilotType::px4;
    const bool tilts_evenly = vehicle_.autopilot == flight::AutopilotType::dji;
    yaw_ += turns_evenly ? even * turn : limited(turn, step * vehicle_.mode.yaw_rate);
    pitch_ += tilts_evenly ? even * tilt : limited(tilt, step * vehicle_.gimbal_rate);
  }
  double yaw() const { return yaw_; }
  double pitch() const { return pitch_; }

 private:
  static double limited(double value, double max) { return std::clamp(value, -max, max); }

  const flight::Vehicle& vehicle_;
  double yaw_, pitch_;
};

/// Returns the recorded part of a sortie as it is flown, on the legs between the waypoints.
std::vector<FlightSample> flown_samples(const flight::FlightPlan& plan) {
  const flight::Recording recording = recorded_stretch(plan);
  constexpr double interval = survey::inspection::sample_interval;
  std::vector<FlightSample> samples;
  FlownAim aim(plan.vehicle, plan.waypoints[recording.first]);
  std::size_t count = 0;
  double begin = 0.0;  // of the leg
  for (std::size_t i = recording.first + 1; i <= recording.last; ++i) {
    const flight::Waypoint &from = plan.waypoints[i - 1], &to = plan.waypoints[i];
    const double length = (to.position - from.position).norm();
    const double duration = std::max(interval, length / leg_speed(plan, i));
    for (; interval * static_cast<double>(count) < begin + duration; ++count) {
      const double elapsed = interval * static_cast<double>(count) - begin;
      FlightSample sample;
      sample.time = interval * static_cast<double>(count);
      sample.position = from.position + elapsed / duration * (to.position - from.position);
      sample.yaw = heading(aim.yaw());
      sample.pitch = aim.pitch();
      samples.push_back(sample);
      aim.advance(to, interval, duration - elapsed);
    }
    begin += duration;
  }
  return samples;
}

}  // namespace

std::vector<flight::CapturePoint> make_waypoints(std::span<const FlightSample> flight) {
  std::vector<flight::CapturePoint> points{make_waypoint(flight.front(), 0, 0.0)};
  for (std::size_t begin = 0; begin + 1 < flight.size();) {
    std::size_t end = begin + 1;
    while (end + 1 < flight.size() && is_followed(flight, begin, end + 1)) ++end;
    points.push_back(
        make_waypoint(flight[end], points.size(), flight[end].time - flight[begin].time));
    points.back().approach_path = {flight[begin].position, flight[end].position};
    begin = end;
  }
  return points;
}

flight::FlightOptions inspection_flight_options(const InspectionSpace& space) {
  flight::FlightOptions options = package::with_fixed_order(space.flight());
  options.style = flight::FlightStyle::stop;
  return options;
}

std::span<const flight::Format> inspection_formats(flight::AutopilotType autopilot) {
  static constexpr std::array dji{flight::Format::kmz};
  static constexpr std::array mavlink{flight::Format::plan, flight::Format::waypoints};
  if (autopilot == flight::AutopilotType::dji) return dji;
  return mavlink;
}

std::string unsupported_reason(flight::Format format) {
  if (format == flight::Format::litchi) {
    return "commands neither an even rotation of the camera nor a recording";
  }
  return flight::captures_images(format) ? "" : "commands neither camera nor speed";
}

void check_deviation(const InspectionFlight& flight, double allowed) {
  if (flight.deviation_bound <= allowed) return;
  throw Error(ErrorKind::bad_geometry,
              fmt::format("the autopilot's curve could deviate by {:.2f} m from the planned one, "
                          "and at most {:.2f} m are allowed",
                          flight.deviation_bound, allowed));
}

InspectionFlight plan_inspection_flight(const config::MissionSetup& setup,
                                        const InspectionSpace& space, const PlannedFlight& planned,
                                        const std::stop_token& stop) {
  flight::FlightOptions flight = inspection_flight_options(space);
  if (planned.pad) flight.takeoff = planned.pad;
  const std::vector<flight::CapturePoint> waypoints = make_waypoints(planned.samples);
  std::vector<geometry::View> views;
  for (const flight::CapturePoint& waypoint : waypoints) views.push_back(waypoint.view);

  InspectionFlight result;
  result.waypoints = waypoints.size();
  result.pad = wizard::choose_takeoff(flight, views);
  result.mission.route =
      package::plan_flight(flight, space.space(), result.pad, waypoints, {}, stop);
  const flight::Route& route = result.mission.route;
  if (route.sorties.empty()) {
    const std::string reason = route.unreached.empty() ? "" : ": " + route.unreached[0].reason;
    throw Error(ErrorKind::bad_geometry, "no waypoint can be reached" + reason);
  }
  survey::inspection::EvaluationOptions evaluation;
  evaluation.camera = planned.camera;
  evaluation.threads = setup.run.threads;
  std::vector<std::uint8_t> rules(planned.cloud.size(), 0);
  double cut = 0.0;
  for (std::size_t sortie = 0; sortie < route.sorties.size(); ++sortie) {
    const flight::FlightPlan flown = flight_plan(route, sortie, setup.name, flight.site);
    cut = std::max(cut, corner_deviation(flown));
    const std::vector<FlightSample> samples = flown_samples(flown);
    constexpr std::size_t min_samples = 4;
    if (samples.size() < min_samples) continue;
    result.recorded_duration += samples.back().time;
    const auto seen = evaluate_flight(samples, planned.cloud, evaluation).rules_seen;
    for (std::size_t i = 0; i < rules.size(); ++i) rules[i] |= seen[i];
  }
  for (const std::uint8_t seen : rules) {
    for (std::size_t rule = 0; rule < sight_rules; ++rule) result.seen[rule] += seen >> rule & 1U;
  }
  // The flight leaves a chord of its samples by at most a dt^2 / 8.
  const double chord = planned.acceleration * survey::inspection::sample_interval *
                       survey::inspection::sample_interval / 8.0;
  result.deviation_bound = sag(planned.samples, waypoints) + cut + chord;
  return result;
}

}  // namespace skycap::missions::inspection
