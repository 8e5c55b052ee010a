#include "survey/inspection/smooth_route.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/error.h"

namespace skycap::survey::inspection {
namespace {

constexpr double min_leg_duration = 0.05;

double turn_between(double from, double to) {
  return std::remainder(to - from, 2.0 * std::numbers::pi);
}

/// Returns the coordinates of a vertex relative to another one, whose yaw is close to it.
Coordinates make_coordinates(const Vertex& vertex, double yaw) {
  Coordinates result;
  result << vertex.position, yaw, vertex.pitch;
  return result;
}

}  // namespace

void MotionLimits::validate() const {
  const auto require = [](double value, const char* name) {
    if (std::isfinite(value) && value > 0.0) return;
    throw Error(ErrorKind::bad_config, std::string(name) + " must be positive");
  };
  require(speed, "speed");
  require(acceleration, "acceleration");
  require(jerk, "jerk");
  require(yaw_rate, "yaw_rate");
  require(yaw_acceleration, "yaw_acceleration");
  require(pitch_rate, "pitch_rate");
  require(ascent, "ascent");
  require(descent, "descent");
}

Smoothing make_smoothing(const MotionLimits& limits) {
  limits.validate();
  // A corner of angle phi changes the velocity by 2 v sin(phi / 2), which is 1.5 v at 97 degrees.
  constexpr double turn = 1.5;
  Smoothing smoothing;
  smoothing.speed = limits.speed;
  smoothing.ascent = limits.ascent;
  smoothing.descent = limits.descent;
  smoothing.longer = turn * limits.speed / limits.acceleration;
  smoothing.shorter = limits.acceleration / limits.jerk;
  if (smoothing.shorter > smoothing.longer) {
    smoothing.longer = smoothing.shorter = std::sqrt(turn * limits.speed / limits.jerk);
  }
  smoothing.yaw_rate = std::min(limits.yaw_rate, 0.5 * limits.yaw_acceleration * smoothing.longer);
  smoothing.pitch_rate = std::min(limits.pitch_rate, smoothing.yaw_rate);
  return smoothing;
}

double leg_duration(const Vertex& from, const Vertex& to, const Smoothing& smoothing) {
  const double climb = to.position.z() - from.position.z();
  return std::max({(to.position - from.position).norm() / smoothing.speed, climb / smoothing.ascent,
                   -climb / smoothing.descent,
                   std::abs(turn_between(from.yaw, to.yaw)) / smoothing.yaw_rate,
                   std::abs(to.pitch - from.pitch) / smoothing.pitch_rate, min_leg_duration}) +
         from.delay;
}

std::vector<double> leg_durations(std::span<const Vertex> vertices, const Smoothing& smoothing) {
  std::vector<double> durations;
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    durations.push_back(leg_duration(vertices[i - 1], vertices[i], smoothing));
  }
  return durations;
}

double flight_duration(std::span<const double> durations, const Smoothing& smoothing) {
  double sum = smoothing.shorter + smoothing.longer;
  for (const double duration : durations) sum += duration;
  return sum;
}

void IntervalCurve::set(std::span<const Vertex> vertices, std::span<const double> durations,
                        const Smoothing& smoothing, std::size_t interval) {
  reach_ = smoothing.reach();
  inner_ = smoothing.inner();
  weight_ = 1.0 / (smoothing.shorter * smoothing.longer);
  const std::size_t origin = interval == 0 ? 0 : interval - 1;
  begin_ = interval == 0 ? -reach_ : 0.0;
  end_ = interval == 0 ? 0.0 : (interval < vertices.size() ? durations[origin] : reach_);
  origin_ = make_coordinates(vertices[origin], vertices[origin].yaw);

  // Knots backwards to begin - a, then forwards to end + a, with times relative to the origin.
  knots_.clear();
  double time = 0.0, yaw = vertices[origin].yaw;
  std::size_t i = origin;
  const auto add = [&] {
    Knot knot{time, make_coordinates(vertices[i], yaw) - origin_, Coordinates::Zero(),
              Coordinates::Zero(), Coordinates::Zero()};
    knots_.push_back(knot);
  };
  while (i > 0 && time > begin_ - reach_) {
    --i;
    time -= durations[i];
    yaw -= turn_between(vertices[i].yaw, vertices[i + 1].yaw);
    add();
  }
  std::reverse(knots_.begin(), knots_.end());
  time = 0.0;
  yaw = vertices[origin].yaw;
  i = origin;
  add();
  while (i + 1 < vertices.size() && time < end_ + reach_) {
    time += durations[i];
    yaw += turn_between(vertices[i].yaw, vertices[i + 1].yaw);
    ++i;
    add();
  }
  for (std::size_t n = 0; n + 1 < knots_.size(); ++n) {
    Knot& knot = knots_[n];
    Knot& next = knots_[n + 1];
    const double duration = next.time - knot.time;
    knot.slope = (next.value - knot.value) / duration;
    next.first = knot.first + duration * (knot.value + 0.5 * duration * knot.slope);
    next.second =
        knot.second +
        duration * (knot.first + duration * (0.5 * knot.value + duration / 6.0 * knot.slope));
  }
  jumps_.assign({begin_, end_});
  for (const Knot& knot : knots_) {
    for (const double shift : {-reach_, -inner_, inner_, reach_}) {
      const double jump = knot.time + shift;
      if (jump > begin_ && jump < end_) jumps_.push_back(jump);
    }
  }
  std::sort(jumps_.begin(), jumps_.end());
}

/// Returns the last knot at or before a time, or the first knot.
const IntervalCurve::Knot& IntervalCurve::knot_before(double time) const {
  std::size_t i = knots_.size() - 1;
  while (i > 0 && knots_[i].time > time) --i;
  return knots_[i];
}

Coordinates IntervalCurve::value_at(double time) const {
  const Knot& knot = knot_before(time);
  const double after = time - knot.time;
  if (after <= 0.0) return knot.value;
  return knot.value + after * knot.slope;
}

Coordinates IntervalCurve::slope_at(double time) const {
  const Knot& knot = knot_before(time);
  if (time < knot.time) return Coordinates::Zero();
  return knot.slope;
}

Coordinates IntervalCurve::first_at(double time) const {
  const Knot& knot = knot_before(time);
  const double after = time - knot.time;
  if (after <= 0.0) return knot.first + after * knot.value;
  return knot.first + after * (knot.value + 0.5 * after * knot.slope);
}

Coordinates IntervalCurve::second_at(double time) const {
  const Knot& knot = knot_before(time);
  const double after = time - knot.time;
  if (after <= 0.0) return knot.second + after * (knot.first + 0.5 * after * knot.value);
  return knot.second + after * (knot.first + after * (0.5 * knot.value + after / 6.0 * knot.slope));
}

Coordinates IntervalCurve::position(double time) const {
  return origin_ + weight_ * (second_at(time + reach_) - second_at(time + inner_) -
                              second_at(time - inner_) + second_at(time - reach_));
}

Coordinates IntervalCurve::velocity(double time) const {
  return weight_ * (first_at(time + reach_) - first_at(time + inner_) - first_at(time - inner_) +
                    first_at(time - reach_));
}

Coordinates IntervalCurve::acceleration(double time) const {
  return weight_ * (value_at(time + reach_) - value_at(time + inner_) - value_at(time - inner_) +
                    value_at(time - reach_));
}

Coordinates IntervalCurve::jerk(double time) const {
  return weight_ * (slope_at(time + reach_) - slope_at(time + inner_) - slope_at(time - inner_) +
                    slope_at(time - reach_));
}

std::vector<FlightSample> sample_flight(std::span<const Vertex> vertices,
                                        const Smoothing& smoothing, double interval) {
  if (!(interval > 0.0)) {
    throw Error(ErrorKind::bad_config, "the sampling interval must be positive");
  }
  std::vector<FlightSample> samples;
  if (vertices.empty()) return samples;
  const std::vector<double> durations = leg_durations(vertices, smoothing);
  const double end = flight_duration(durations, smoothing);
  const auto count = static_cast<std::size_t>(std::ceil(end / interval - 1e-9)) + 1;
  IntervalCurve curve;
  double begin = 0.0, yaw = vertices.front().yaw;  // flight time at the vertex of the interval
  std::size_t next = 0;
  for (std::size_t i = 0; i <= vertices.size(); ++i) {
    if (i == 1) begin = smoothing.reach();
    if (i >= 2) {
      begin += durations[i - 2];
      yaw += turn_between(vertices[i - 2].yaw, vertices[i - 1].yaw);
    }
    curve.set(vertices, durations, smoothing, i);
    const double origin = i == 0 ? smoothing.reach() : begin;
    const double unwrap = yaw - vertices[i == 0 ? 0 : i - 1].yaw;
    const bool is_last = i == vertices.size();
    while (next < count) {
      const double time = static_cast<double>(next) * interval;
      if (!is_last && time - origin >= curve.end()) break;
      const Coordinates at = curve.position(std::min(time - origin, curve.end()));
      samples.push_back({time, at.head<3>(), at[3] + unwrap, at[4]});
      ++next;
    }
  }
  return samples;
}

}  // namespace skycap::survey::inspection
