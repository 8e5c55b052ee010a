/// Continuous flights in closed form: a polygon of poses that is flown at full speed and smoothed
/// by two moving averages over time.
///
/// Mission frame [m], z up. Yaw is counter-clockwise from +x (east), pitch is 0 at the horizon and
/// positive upwards [rad]. The polygon gives a signal r(t) that is linear between vertices and
/// constant before the first and after the last vertex. The flown curve is the average of r over
/// two windows of lengths T1 and T2, one after the other. With F1 and F2, the first and second
/// integrals of r, a = (T1 + T2) / 2, b = (T2 - T1) / 2 and k = 1 / (T1 T2):
///
///     q(t)   = k [F2(t + a) - F2(t + b) - F2(t - b) + F2(t - a)]
///     q''(t) = k [r(t + a) - r(t + b) - r(t - b) + r(t - a)]
///
/// The averages keep the limits of speed, yaw rate, yaw acceleration and pitch. A single corner of
/// at most 97 degrees also keeps the limits of acceleration and jerk.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace skycap::survey::inspection {

/// Limits of the flight. Speed, acceleration and jerk are Euclidean norms.
struct MotionLimits {
  double speed = 2.0;                            ///< [m/s]
  double acceleration = 1.0;                     ///< [m/s^2]
  double jerk = 0.5;                             ///< [m/s^3]
  double yaw_rate = 1.0471975511965976;          ///< [rad/s]
  double yaw_acceleration = 0.5235987755982988;  ///< [rad/s^2]
  double pitch_rate = 0.7853981633974483;        ///< [rad/s]
  double ascent = 2.0;                           ///< Vertical speed upwards [m/s].
  double descent = 2.0;                          ///< Vertical speed downwards [m/s].

  /// Throws Error{bad_config} naming the first limit that is not positive.
  void validate() const;
};

/// Windows of the moving averages and rates of the polygon that keep given limits.
struct Smoothing {
  double shorter = 2.0;                    ///< T1 [s]
  double longer = 3.0;                     ///< T2 [s], at least T1
  double yaw_rate = 0.7853981633974483;    ///< Maximum yaw rate of the polygon [rad/s].
  double pitch_rate = 0.7853981633974483;  ///< Maximum pitch rate of the polygon [rad/s].
  double speed = 2.0;                      ///< Speed of the polygon [m/s].
  double ascent = 2.0;                     ///< Its vertical speed upwards [m/s].
  double descent = 2.0;                    ///< Its vertical speed downwards [m/s].

  double reach() const { return 0.5 * (shorter + longer); }  ///< a [s]
  double inner() const { return 0.5 * (longer - shorter); }  ///< b [s]
};

/// Returns the shortest windows for which a corner of 97 degrees keeps the limits: T2 = 1.5 v / a
/// and T1 = a / j, or two equal windows if T1 would exceed T2.
Smoothing make_smoothing(const MotionLimits& limits);

/// Corner of the polygon.
struct Vertex {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double yaw = 0.0;  ///< In [-pi, pi].
  double pitch = 0.0;
  double delay = 0.0;  ///< Time added to the leg that begins here [s].

  bool operator==(const Vertex& other) const = default;
};

/// Returns the duration of the leg between two vertices [s]. Yaw turns by at most pi.
double leg_duration(const Vertex& from, const Vertex& to, const Smoothing& smoothing);

/// Returns the durations of all legs of a polygon.
std::vector<double> leg_durations(std::span<const Vertex> vertices, const Smoothing& smoothing);

/// Returns the duration of the flight, from rest to rest [s].
double flight_duration(std::span<const double> durations, const Smoothing& smoothing);

/// x, y, z [m], yaw and pitch [rad], or a time derivative of them.
using Coordinates = Eigen::Matrix<double, 5, 1>;

/// The flown curve over one interval of the polygon. A polygon of M vertices has M + 1 intervals:
/// 0 is the time before the first vertex, k is the leg from vertex k - 1, M is the time after the
/// last vertex. The result depends only on the vertices within a of the interval, bit by bit.
class IntervalCurve {
 public:
  /// Prepares interval `interval`. Requires at least one vertex. Reuses memory.
  void set(std::span<const Vertex> vertices, std::span<const double> durations,
           const Smoothing& smoothing, std::size_t interval);

  /// Times of the interval, relative to the vertex at which it begins (interval 0: ends) [s].
  double begin() const { return begin_; }
  double end() const { return end_; }

  /// Coordinates at a time in the interval. Yaw is continuous, and near the yaw of the vertex.
  Coordinates position(double time) const;
  Coordinates velocity(double time) const;
  Coordinates acceleration(double time) const;
  /// The jerk is constant between jumps(), where its value is undefined.
  Coordinates jerk(double time) const;

  /// Returns begin(), the times in between at which the jerk changes, and end(), ascending.
  const std::vector<double>& jumps() const { return jumps_; }

 private:
  struct Knot {
    double time;
    Coordinates value, slope, first, second;  // slope of the following leg; F1, F2 at the knot
  };
  const Knot& knot_before(double time) const;
  Coordinates value_at(double time) const;
  Coordinates slope_at(double time) const;
  Coordinates first_at(double time) const;
  Coordinates second_at(double time) const;

  std::vector<Knot> knots_;
  std::vector<double> jumps_;
  Coordinates origin_ = Coordinates::Zero();
  double begin_ = 0.0, end_ = 0.0, reach_ = 0.0, inner_ = 0.0, weight_ = 0.0;
};

/// State of a flight at one time. Time 0 is the start at rest.
struct FlightSample {
  double time = 0.0;                                   ///< [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  double yaw = 0.0;                                    ///< Continuous, so it may exceed pi [rad].
  double pitch = 0.0;                                  ///< [rad]
};

/// Returns the flight every `interval` seconds from its start. The last sample is the first one at
/// or after the end, where the vehicle rests. Throws Error{bad_config} unless the interval is
/// positive.
std::vector<FlightSample> sample_flight(std::span<const Vertex> vertices,
                                        const Smoothing& smoothing, double interval);

}  // namespace skycap::survey::inspection
