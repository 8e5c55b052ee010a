#include "missions/session/en_route_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "geometry/pose/camera.h"
#include "geometry/pose/platform.h"

namespace skycap::missions::session {
namespace {

using Eigen::Vector3d;
using geometry::View;

double turn_between(const View& from, const View& to) {
  return std::remainder(flight::compute_yaw(to) - flight::compute_yaw(from),
                        2.0 * std::numbers::pi);
}

/// Returns the direction after the fraction `share` of the rotation between two views.
Vector3d direction_between(const View& from, const View& to, double share) {
  const double yaw = flight::compute_yaw(from) + share * turn_between(from, to);
  const double pitch = flight::compute_pitch(from) +
                       share * (flight::compute_pitch(to) - flight::compute_pitch(from));
  return {std::cos(pitch) * std::sin(yaw), std::cos(pitch) * std::cos(yaw), std::sin(pitch)};
}

struct FlightState {
  Vector3d position, velocity;
};

/// Returns position and velocity on a straight segment of duration `duration` after the fraction
/// `share` of this time. The seven-phase profile approximates those of all autopilots.
FlightState state_on_leg(const Vector3d& begin, const Vector3d& end, const flight::Motion& motion,
                         double duration, double share) {
  const double distance = (end - begin).norm();
  const Vector3d direction = (end - begin) / distance;
  const double speed = motion.leg_speed(direction),
               acceleration = motion.leg_acceleration(direction);
  const double jerk = motion.vehicle().mode.jerk;
  const double all = flight::rest_to_rest_time(distance, speed, acceleration, jerk);
  const auto state = flight::rest_to_rest_state(distance, speed, acceleration, jerk, share * all);
  return {begin + std::min(state.distance, distance) * direction,
          all / duration * state.speed * direction};
}

}  // namespace

LegMotion::LegMotion(const flight::FlightOptions& options)
    : motion_(options.required_vehicle(), options.route(Vector3d::Zero()).conditions),
      climb_(options.climb()),
      rest_(std::max(flight::corner_hold, options.rest_before()) + options.rest_after()),
      turns_last_(options.capture.mount.has_value()) {}

double LegMotion::time(const ExecutedLeg& flown_leg, const View& from, const View& to) const {
  double time = 0.0;
  for (std::size_t i = 1; i < flown_leg.points.size(); ++i) {
    const double segment_time = motion_.leg_time(flown_leg.points[i] - flown_leg.points[i - 1]);
    const bool is_last = i + 1 == flown_leg.points.size();
    time += is_last ? motion_.aimed_time(segment_time, turn_between(from, to),
                                         flight::compute_pitch(to) - flight::compute_pitch(from))
                    : segment_time + flight::corner_hold;
  }
  return time;
}

std::vector<ViewInFlight> LegMotion::frames(const ExecutedLeg& flown_leg, const View& from,
                                            const View& to, double period) const {
  const double all = time(flown_leg, from, to);
  std::vector<ViewInFlight> frames;
  std::size_t number = 1;
  double begun = 0.0;
  for (std::size_t i = 1; i < flown_leg.points.size(); ++i) {
    const Vector3d &begin = flown_leg.points[i - 1], &end = flown_leg.points[i];
    const double segment_time = motion_.leg_time(end - begin);
    while (segment_time > 0.0) {
      const double at = static_cast<double>(number) * period;
      if (at > begun + segment_time || at > all - 0.5 * period) break;
      const FlightState state =
          state_on_leg(begin, end, motion_, segment_time, (at - begun) / segment_time);
      const auto view_at = [&](double moment) {
        const double on_last =
            i + 1 < flown_leg.points.size() ? 0.0 : (moment - begun) / (all - begun);
        return View{state_on_leg(begin, end, motion_, segment_time, (moment - begun) / segment_time)
                        .position,
                    direction_between(from, to, turns_last_ ? on_last : moment / all)};
      };
      frames.push_back({view_at(at), state.velocity, at});
      if (turns_last_) {
        const double first = std::max(at - 0.5 * period, begun);
        const double last = std::min(at + 0.5 * period, begun + segment_time);
        frames.back().stretch = {view_at(first), view_at(last), last - first};
      }
      ++number;
    }
    begun += segment_time + flight::corner_hold;
    // Frames during the stop at a corner are taken after the stop.
  }
  return frames;
}

std::vector<double> LegMotion::survey_times(const std::vector<ExecutedLeg>& legs,
                                            const std::vector<View>& views) const {
  std::vector<double> times;
  double now = motion_.takeoff_time(climb_) + flight::corner_hold;
  for (std::size_t i = 0; i < views.size(); ++i) {
    now += time(legs[i], i > 0 ? views[i - 1] : views[i], views[i]) + rest_;
    times.push_back(now);
  }
  return times;
}

namespace {

/// Collects the measurements of all sorties.
class RouteViews {
 public:
  RouteViews(const flight::FlightOptions& options, const flight::Route& route)
      : route_(route), motion_(options), period_(options.capture.frame_period) {
    if (options.capture.scans_in_flight()) mount_ = options.capture.mount;
  }

  std::vector<ViewInFlight> all() {
    for (const flight::Sortie& sortie : route_.sorties) {
      if (sortie.fly_through) {
        mount_ ? scan_fly_through(*sortie.fly_through) : capture_images(sortie);
      } else {
        fly(sortie);
      }
      now_ += period_;
    }
    return std::move(views_);
  }

 private:
  void fly(const flight::Sortie& sortie) {
    const View &first = route_.capture_points[sortie.first].view,
               &last = route_.capture_points[sortie.last].view;
    fly(sortie.out, first, first);
    for (std::uint32_t i = sortie.first; i < sortie.last; ++i) {
      fly(route_.legs[i], route_.capture_points[i].view, route_.capture_points[i + 1].view);
    }
    if (mount_) fly(sortie.back, last, last);
  }

  /// Adds the en-route scans of a leg and the measurement at its end.
  void fly(const flight::Leg& leg, const View& from, const View& to) {
    const ExecutedLeg flown_leg{leg.points};
    if (mount_) {
      for (const ViewInFlight& nose : motion_.frames(flown_leg, from, to, period_)) {
        add(geometry::scanner_view(*mount_, nose.view), nose.velocity, nose.time);
        views_.back().stretch = nose.stretch;
      }
    }
    now_ += motion_.time(flown_leg, from, to);
    View view = to;
    if (mount_) view = geometry::scanner_view(*mount_, {leg.points.back(), to.direction});
    add(view, Vector3d::Zero(), 0.0);
    now_ += motion_.rest();
  }

  static View nose_on(const flight::FlyThrough& fly_through, double time) {
    return {state_at(fly_through.curve, time).position,
            compute_direction(fly_through.aim_at(time))};
  }

  void scan_fly_through(const flight::FlyThrough& fly_through) {
    for (std::size_t k = 1; static_cast<double>(k) * period_ < fly_through.duration; ++k) {
      const double time = static_cast<double>(k) * period_;
      const View nose = nose_on(fly_through, time);
      add(geometry::scanner_view(*mount_, nose), state_at(fly_through.curve, time).velocity, time);
      const double last = std::min(time + 0.5 * period_, fly_through.duration);
      const double first = time - 0.5 * period_;
      views_.back().stretch = {nose_on(fly_through, first), nose_on(fly_through, last),
                               last - first};
    }
    now_ += fly_through.duration;
  }

  void capture_images(const flight::Sortie& sortie) {
    const flight::FlyThrough& fly_through = *sortie.fly_through;
    for (std::uint32_t i = sortie.first; i <= sortie.last; ++i) {
      const flight::PassedView& photo = fly_through.views[i - sortie.first];
      add({photo.position, route_.capture_points[i].view.direction},
          state_at(fly_through.curve, photo.moment).velocity, photo.moment);
    }
    now_ += fly_through.duration;
  }

  void add(const View& view, const Vector3d& velocity, double time) {
    views_.push_back({view, velocity, now_ + time});
  }

  const flight::Route& route_;
  LegMotion motion_;
  double period_;
  std::optional<geometry::ScannerMount> mount_;  ///< Set for scanners.
  double now_ = 0.0;
  std::vector<ViewInFlight> views_;
};

}  // namespace

std::vector<ViewInFlight> measured_views(const flight::FlightOptions& options,
                                         const flight::Route& route) {
  return RouteViews(options, route).all();
}

flight::ImageMotionBounds compute_motion_bounds(const flight::FlightOptions& options) {
  flight::Vehicle vehicle = options.required_vehicle();
  vehicle.sway_speed += options.cruise_speed;
  const flight::CaptureOptions& capture = options.capture;
  return image_motion_bounds(vehicle, geometry::Camera(capture.camera), capture.shutter,
                             capture.view_distance);
}

}  // namespace skycap::missions::session
