#include "flight/interpreter/photographs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "flight/export/export.h"
#include "flight/export/photo_runs.h"
#include "geometry/angle.h"

namespace skycap::flight {
namespace {

constexpr double degree = geometry::radians_per_degree;

/// Maximum angle between a photo and its view: Litchi stores whole degrees of pitch.
constexpr double direction_tolerance = 1.0 * degree;

/// Maximum distance between a photo and its view [m]: rounding, and ArduPilot's centimetres of
/// height.
constexpr double position_tolerance = 2.0 * rounding_bound;

/// Rounding of times in the formats [s].
constexpr double hold_tolerance = 0.005;

/// A photograph, at a stop or without one.
struct Photograph {
  Eigen::Vector3d position;
  std::string item;
  double yaw_deg, pitch_deg;
  double tolerance;         ///< of its position [m]
  double speed = 0.0;       ///< at the exposure; unspecified: the file does not say [m/s]
  double hold = 0.0;        ///< at rest before it [s]
  double hold_after = 0.0;  ///< at rest after it [s]

  bool is_at_rest() const { return speed == 0.0; }
};

Photograph make_photograph(const InterpretedStop& stop) {
  return {stop.position,      stop.item, stop.yaw_deg, stop.pitch_deg,
          position_tolerance, 0.0,       stop.hold,    stop.hold_after};
}

Photograph make_photograph(const FlownPass& pass) {
  return {pass.position,
          pass.item,
          pass.yaw_deg,
          pass.pitch_deg,
          position_tolerance + run_evenness * pass.spacing,
          pass.speed};
}

/// All of a route, in the order taken.
std::vector<Photograph> list_photographs(const InterpretedRoute& route) {
  std::vector<Photograph> photographs;
  auto pass = route.is_fly_through.begin();
  for (std::size_t i = 0; i <= route.stops.size(); ++i) {
    for (; pass != route.is_fly_through.end() && pass->stops_before <= i; ++pass) {
      photographs.push_back(make_photograph(*pass));
    }
    if (i < route.stops.size()) photographs.push_back(make_photograph(route.stops[i]));
  }
  return photographs;
}

Eigen::Vector3d compute_direction(const Photograph& photograph) {
  const double yaw = photograph.yaw_deg * degree, pitch = photograph.pitch_deg * degree;
  return {std::cos(pitch) * std::sin(yaw), std::cos(pitch) * std::cos(yaw), std::sin(pitch)};
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Returns the mismatch between a photo and the views, or an empty string.
std::string compare(const Photograph& photograph, const std::vector<geometry::View>& views) {
  double turned = std::numbers::pi;
  bool is_matched = false;
  for (const geometry::View& view : views) {
    if ((view.position - photograph.position).norm() > photograph.tolerance) continue;
    is_matched = true;
    turned = std::min(turned, angle_between(compute_direction(photograph), view.direction));
  }
  if (!is_matched) return "captures an image at a position that is not a view of the mission";
  if (std::isnan(photograph.yaw_deg)) return "captures an image without a heading";
  if (std::isnan(photograph.pitch_deg)) return "captures an image without a gimbal pitch";
  if (turned <= direction_tolerance) return "";
  return "captures an image " + fixed(turned / degree, 1) + " degrees away from its view";
}

/// The least time between two photographs [s], flown at the mission's cruise speed where the file
/// does not say a speed.
double min_time(const Photograph& from, const Photograph& to, const FlightFacts& facts) {
  double speed = facts.cruise_speed;
  for (const Photograph* photograph : {&from, &to}) {
    if (photograph->speed > 0.0) speed = std::min(speed, photograph->speed);
  }
  double time = from.hold_after + (to.position - from.position).norm() / speed;
  if (to.is_at_rest()) time += to.hold + (facts.vehicle ? facts.vehicle->mode.settle_time : 0.0);
  return time;
}

/// How much more formats may say than is allowed, by rounding [m/s, s].
constexpr double speed_tolerance = 0.01, interval_tolerance = 0.01;

/// What is wrong with a photograph that follows another one (nullptr: the first), for the camera.
std::string compare(const Photograph& photograph, const Photograph* previous,
                    const FlightFacts& facts) {
  if (!photograph.is_at_rest()) {
    const PhotoSpeeds limits =
        photo_speeds(*facts.photo, std::numeric_limits<double>::infinity(), facts.cruise_speed);
    if (!(photograph.speed <= limits.min() + speed_tolerance)) {
      return "captures an image at " + fixed(photograph.speed, 2) + " m/s; it must be at most " +
             fixed(limits.min(), 2) + " m/s (" + limits.limit() + ")";
    }
  }
  if (previous == nullptr) return "";
  const double time = min_time(*previous, photograph, facts);
  if (time >= facts.photo->min_interval - interval_tolerance) return "";
  return "captures an image " + fixed(time, 2) +
         " s after the previous one; the camera's minimum interval is " +
         fixed(facts.photo->min_interval, 2) + " s";
}

}  // namespace

Problems check_photographs(const InterpretedRoute& route, const FlightFacts& facts) {
  Problems problems;
  const Photograph* previous = nullptr;
  const std::vector<Photograph> photographs = list_photographs(route);
  for (const Photograph& photograph : photographs) {
    const auto add_problem = [&](const std::string& what) {
      if (!what.empty()) problems.push_back(photograph.item + " " + what);
    };
    if (photograph.is_at_rest() && photograph.hold < facts.hold - hold_tolerance) {
      add_problem("holds " + fixed(photograph.hold, 2) +
                  " s before its image; the mission requires " + fixed(facts.hold, 2) + " s");
    }
    if (facts.vehicle) {
      const double pitch = photograph.pitch_deg * degree;
      if (pitch < facts.vehicle->gimbal_min - direction_tolerance ||
          pitch > facts.vehicle->gimbal_max + direction_tolerance) {
        add_problem("pitches the gimbal to " + fixed(photograph.pitch_deg, 1) +
                    " degrees, which \"" + facts.vehicle->name + "\" cannot");
      }
    }
    if (facts.photo) add_problem(compare(photograph, previous, facts));
    if (!facts.views.empty()) add_problem(compare(photograph, facts.views));
    previous = &photograph;
  }
  return problems;
}

Problems missing_photographs(const InterpretedRoute& route, const FlightFacts& facts) {
  Problems problems;
  const std::vector<Photograph> photographs = list_photographs(route);
  for (const geometry::View& view : facts.views) {
    const bool is_taken = std::ranges::any_of(photographs, [&](const Photograph& photograph) {
      return (view.position - photograph.position).norm() <= photograph.tolerance &&
             angle_between(compute_direction(photograph), view.direction) <= direction_tolerance;
    });
    if (is_taken) continue;
    problems.push_back("no image is captured at the view at (" + fixed(view.position.x(), 2) +
                       ", " + fixed(view.position.y(), 2) + ", " + fixed(view.position.z(), 2) +
                       ")");
  }
  return problems;
}

}  // namespace skycap::flight
