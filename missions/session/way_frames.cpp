#include "missions/session/way_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "geometry/place/camera.h"
#include "geometry/place/platform.h"

namespace skycap::missions::session {
namespace {

using Eigen::Vector3d;
using geometry::View;

double turn_between(const View& from, const View& to) {
  return std::remainder(flight::yaw_of(to) - flight::yaw_of(from), 2.0 * std::numbers::pi);
}

/// Returns the direction after the fraction `share` of the rotation between two views.
Vector3d direction_between(const View& from, const View& to, double share) {
  const double yaw = flight::yaw_of(from) + share * turn_between(from, to);
  const double pitch =
      flight::pitch_of(from) + share * (flight::pitch_of(to) - flight::pitch_of(from));
  return {std::cos(pitch) * std::sin(yaw), std::cos(pitch) * std::cos(yaw), std::sin(pitch)};
}

struct PlaceInFlight {
  Vector3d position, velocity;
};

/// Returns position and velocity on a straight segment of duration `duration` after the fraction
/// `share` of this time. The seven-phase profile approximates those of all autopilots.
PlaceInFlight place_on(const Vector3d& begin, const Vector3d& end, const flight::Motion& motion,
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

WayMotion::WayMotion(const flight::FlightOptions& options)
    : motion_(options.flown(), options.route(Vector3d::Zero()).conditions),
      climb_(options.climb()),
      rest_(std::max(flight::corner_hold, options.rest_before()) + options.rest_after()),
      turns_last_(options.capture.mount.has_value()) {}

double WayMotion::time(const FlownLeg& way, const View& from, const View& to) const {
  double time = 0.0;
  for (std::size_t i = 1; i < way.points.size(); ++i) {
    const double piece = motion_.leg_time(way.points[i] - way.points[i - 1]);
    const bool is_last = i + 1 == way.points.size();
    time += is_last ? motion_.aimed_time(piece, turn_between(from, to),
                                         flight::pitch_of(to) - flight::pitch_of(from))
                    : piece + flight::corner_hold;
  }
  return time;
}

std::vector<ViewInFlight> WayMotion::frames(const FlownLeg& way, const View& from, const View& to,
                                            double period) const {
  const double all = time(way, from, to);
  std::vector<ViewInFlight> frames;
  std::size_t number = 1;
  double begun = 0.0;
  for (std::size_t i = 1; i < way.points.size(); ++i) {
    const Vector3d &begin = way.points[i - 1], &end = way.points[i];
    const double piece = motion_.leg_time(end - begin);
    while (piece > 0.0) {
      const double at = static_cast<double>(number) * period;
      if (at > begun + piece || at > all - 0.5 * period) break;
      const PlaceInFlight place = place_on(begin, end, motion_, piece, (at - begun) / piece);
      const auto view_at = [&](double moment) {
        const double on_last = i + 1 < way.points.size() ? 0.0 : (moment - begun) / (all - begun);
        return View{place_on(begin, end, motion_, piece, (moment - begun) / piece).position,
                    direction_between(from, to, turns_last_ ? on_last : moment / all)};
      };
      frames.push_back({view_at(at), place.velocity, at});
      if (turns_last_) {
        const double first = std::max(at - 0.5 * period, begun);
        const double last = std::min(at + 0.5 * period, begun + piece);
        frames.back().stretch = {view_at(first), view_at(last), last - first};
      }
      ++number;
    }
    begun += piece + flight::corner_hold;
    // Frames during the stop at a corner are taken after the stop.
  }
  return frames;
}

std::vector<double> WayMotion::survey_times(const std::vector<FlownLeg>& legs,
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
      if (sortie.passage) {
        mount_ ? scan_passage(*sortie.passage) : take_pictures(sortie);
      } else {
        fly(sortie);
      }
      now_ += period_;
    }
    return std::move(views_);
  }

 private:
  void fly(const flight::Sortie& sortie) {
    const View &first = route_.stations[sortie.first].view,
               &last = route_.stations[sortie.last].view;
    fly(sortie.out, first, first);
    for (std::uint32_t i = sortie.first; i < sortie.last; ++i) {
      fly(route_.legs[i], route_.stations[i].view, route_.stations[i + 1].view);
    }
    if (mount_) fly(sortie.back, last, last);
  }

  /// Adds the en-route scans of a leg and the measurement at its end.
  void fly(const flight::Leg& leg, const View& from, const View& to) {
    const FlownLeg way{leg.points};
    if (mount_) {
      for (const ViewInFlight& nose : motion_.frames(way, from, to, period_)) {
        add(geometry::scanner_view(*mount_, nose.view), nose.velocity, nose.time);
        views_.back().stretch = nose.stretch;
      }
    }
    now_ += motion_.time(way, from, to);
    View view = to;
    if (mount_) view = geometry::scanner_view(*mount_, {leg.points.back(), to.direction});
    add(view, Vector3d::Zero(), 0.0);
    now_ += motion_.rest();
  }

  static View nose_on(const flight::Passage& passage, double time) {
    return {state_at(passage.curve, time).position, direction_of(passage.aim_at(time))};
  }

  void scan_passage(const flight::Passage& passage) {
    for (std::size_t k = 1; static_cast<double>(k) * period_ < passage.duration; ++k) {
      const double time = static_cast<double>(k) * period_;
      const View nose = nose_on(passage, time);
      add(geometry::scanner_view(*mount_, nose), state_at(passage.curve, time).velocity, time);
      const double last = std::min(time + 0.5 * period_, passage.duration);
      const double first = time - 0.5 * period_;
      views_.back().stretch = {nose_on(passage, first), nose_on(passage, last), last - first};
    }
    now_ += passage.duration;
  }

  void take_pictures(const flight::Sortie& sortie) {
    const flight::Passage& passage = *sortie.passage;
    for (std::uint32_t i = sortie.first; i <= sortie.last; ++i) {
      const flight::PassedView& picture = passage.views[i - sortie.first];
      add({picture.position, route_.stations[i].view.direction},
          state_at(passage.curve, picture.moment).velocity, picture.moment);
    }
    now_ += passage.duration;
  }

  void add(const View& view, const Vector3d& velocity, double time) {
    views_.push_back({view, velocity, now_ + time});
  }

  const flight::Route& route_;
  WayMotion motion_;
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

flight::PictureBounds moving_bounds_of(const flight::FlightOptions& options) {
  flight::Vehicle vehicle = options.flown();
  vehicle.sway_speed += options.cruise_speed;
  const flight::CaptureOptions& capture = options.capture;
  return picture_bounds(vehicle, geometry::Camera(capture.camera), capture.shutter,
                        capture.view_distance);
}

}  // namespace skycap::missions::session
