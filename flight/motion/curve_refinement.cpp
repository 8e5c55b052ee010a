#include "flight/motion/curve_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <ceres/autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Target duration of a piece and limits on the number of pieces. A joint has nine variables, and
/// the cost of a solver step is cubic in their number.
constexpr double segment_duration = 0.8;
constexpr std::size_t min_pieces = 6, max_pieces = 32;
constexpr int max_iterations = 20;
/// Number of solutions, and the factor of each duration relative to the last required one.
constexpr int rounds = 8;
constexpr double haste = 0.92;

/// Weight of flight at full jerk, in equivalent seconds.
constexpr double jerk_weight = 1.0;
/// Weight of the squared excess for twice the speed limit at each control point, in equivalent
/// seconds.
constexpr double speed_weight = 10.0;
/// Weight of the squared penetration of 1 m into the wall at each sample, in equivalent seconds.
constexpr double wall_weight = 400.0;
/// Number of distance samples on a piece in addition to its start.
constexpr int residual_count = 5;

/// Position of a joint, and its velocity and acceleration scaled by the common duration of the
/// pieces. The path is then independent of the duration, and both can be improved together.
using Joint = std::array<double, 9>;

template <class T>
using Vector = Eigen::Matrix<T, 3, 1>;

template <class T>
std::array<Vector<T>, 6> control_points(const T* from, const T* to) {
  const auto part = [](const T* joint, std::size_t i) {
    return Vector<T>(joint[3 * i], joint[3 * i + 1], joint[3 * i + 2]);
  };
  return {part(from, 0),
          part(from, 0) + 0.2 * part(from, 1),
          part(from, 0) + 0.4 * part(from, 1) + 0.05 * part(from, 2),
          part(to, 0) - 0.4 * part(to, 1) + 0.05 * part(to, 2),
          part(to, 0) - 0.2 * part(to, 1),
          part(to, 0)};
}

template <class T>
T hinge(const T& value) {
  return value > T(0.0) ? value : T(0.0);
}

/// Jerk and speeds of one piece. Accelerations need no penalty: minimum jerk distributes them
/// evenly, and the final slowdown covers the rest.
struct SegmentCost {
  static constexpr int residuals = 9 + 5 * 3;

  double duration, speed, ascent, descent, jerk;

  template <class T>
  bool operator()(const T* from, const T* to, T* residual) const {
    const double rate = 1.0 / duration;
    const auto c = control_points(from, to);

    // The integral of a squared Bezier curve of degree 2 is the duration times a quadratic form of
    // its control points with this matrix. Its Cholesky factor converts it to a sum of squares.
    static const Eigen::Matrix3d factor = [] {
      Eigen::Matrix3d gram;
      gram << 1.0 / 5, 1.0 / 10, 1.0 / 30, 1.0 / 10, 2.0 / 15, 1.0 / 10, 1.0 / 30, 1.0 / 10,
          1.0 / 5;
      return Eigen::Matrix3d(gram.llt().matrixU());
    }();
    std::array<Vector<T>, 3> jerks;
    for (std::size_t i = 0; i < 3; ++i) {
      jerks[i] = 60.0 * rate * rate * rate * (c[i + 3] - 3.0 * c[i + 2] + 3.0 * c[i + 1] - c[i]);
    }
    const double scale = std::sqrt(jerk_weight * duration) / jerk;
    for (int row = 0; row < 3; ++row) {
      for (int axis = 0; axis < 3; ++axis) {
        T sum(0.0);
        for (int i = row; i < 3; ++i)
          sum += factor(row, i) * jerks[static_cast<std::size_t>(i)][axis];
        *residual++ = scale * sum;
      }
    }

    const double weight = std::sqrt(speed_weight);
    const auto wall = [&](const T& squared_share) {
      *residual++ = weight * hinge(T(squared_share - 1.0));
    };
    for (std::size_t i = 0; i < 5; ++i) {
      const Vector<T> velocity = 5.0 * rate * (c[i + 1] - c[i]);
      wall(velocity.squaredNorm() / (speed * speed));
      wall(hinge(velocity.z()) * velocity.z() / (ascent * ascent));
      wall(hinge(T(-velocity.z())) * -velocity.z() / (descent * descent));
    }
    return true;
  }
};

/// Penetration of a piece's samples into the wall.
struct WallCost {
  const FreeSpace* space;
  double target_clearance;

  template <class T>
  bool operator()(const T* from, const T* to, T* residual) const {
    const auto c = control_points(from, to);
    for (int i = 0; i < residual_count; ++i) {
      const double u = (i + 0.5) / residual_count, w = 1.0 - u;
      const Vector<T> position = w * w * w * w * w * c[0] + 5 * w * w * w * w * u * c[1] +
                                 10 * w * w * w * u * u * c[2] + 10 * w * w * u * u * u * c[3] +
                                 5 * w * u * u * u * u * c[4] + u * u * u * u * u * c[5];
      residual[i] = std::sqrt(wall_weight) * hinge(T(target_clearance - distance(position)));
    }
    return true;
  }

  /// Returns the distance with its gradient, which points away from the closest obstacle. There is
  /// no gradient at a position that is not free. The neighbouring joints must pull it out.
  template <class T>
  T distance(const Vector<T>& position) const {
    const Vector3d p(value(position.x()), value(position.y()), value(position.z()));
    const Closest closest = space->closest({p, p}, target_clearance);
    const Vector3d away = p - closest.on_obstacle;
    if (closest.kind == ObstacleKind::none || closest.distance <= 0.0 || away.norm() == 0.0) {
      return T(closest.distance);
    }
    const Vector3d slope = away.normalized();
    return closest.distance + slope.x() * (position.x() - p.x()) +
           slope.y() * (position.y() - p.y()) + slope.z() * (position.z() - p.z());
  }

  static double value(double number) { return number; }
  template <class T>
  static double value(const T& jet) {
    return jet.a;
  }
};

CurveState compute_state(const Joint& joint, double duration) {
  return {Vector3d(joint[0], joint[1], joint[2]), Vector3d(joint[3], joint[4], joint[5]) / duration,
          Vector3d(joint[6], joint[7], joint[8]) / (duration * duration)};
}

Joint make_joint(const CurveState& state, double duration) {
  Joint joint;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    joint[i] = state.position[axis];
    joint[3 + i] = state.velocity[axis] * duration;
    joint[6 + i] = state.acceleration[axis] * duration * duration;
  }
  return joint;
}

/// Solves the problem for a given duration, starting from the current joints.
void solve(std::vector<Joint>& joints, const SegmentCost& segment_cost, const WallCost& wall_cost) {
  ceres::Problem problem;
  for (std::size_t i = 0; i + 1 < joints.size(); ++i) {
    double *from = joints[i].data(), *to = joints[i + 1].data();
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<SegmentCost, SegmentCost::residuals, 9, 9>(
            new SegmentCost(segment_cost)),
        nullptr, from, to);
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<WallCost, residual_count, 9, 9>(new WallCost(wall_cost)),
        nullptr, from, to);
  }
  problem.SetParameterBlockConstant(joints.front().data());
  problem.SetParameterBlockConstant(joints.back().data());
  ceres::Solver::Options options;
  options.num_threads = 1;  // Fixed order of summation, for identical results.
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.dense_linear_algebra_library_type = ceres::EIGEN;
  options.max_num_iterations = max_iterations;
  options.max_solver_time_in_seconds = 1e9;  // The limit is the number of iterations, not the time.
  options.function_tolerance = 1e-4;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
}

Curve curve_through(const std::vector<Joint>& joints, double duration) {
  Curve curve;
  for (std::size_t i = 0; i + 1 < joints.size(); ++i) {
    curve.push_back(segment_between(compute_state(joints[i], duration),
                                    compute_state(joints[i + 1], duration), duration));
  }
  return curve;
}

}  // namespace

Curve refine(const Curve& start, const FreeSpace& space, double target_clearance,
             const Motion& motion) {
  const double total = duration(start);
  const std::size_t count =
      std::clamp(static_cast<std::size_t>(total / segment_duration), min_pieces, max_pieces);
  double step = total / static_cast<double>(count);
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < count; ++i) {
    joints.push_back(make_joint(state_at(start, static_cast<double>(i) * step), step));
  }
  joints.push_back(make_joint({start.back().control.back()}, step));

  const Vehicle& vehicle = motion.vehicle();
  const Conditions& conditions = motion.conditions();
  // Against the wind, the vehicle may not reach its cruise speed. This is too strict for a few
  // directions, which do not justify a separate term.
  const double speed =
      std::min(conditions.cruise_speed,
               std::max(vehicle.max_speed - conditions.wind.norm(), 0.1 * vehicle.max_speed));
  const WallCost wall_cost{&space, target_clearance};
  Curve best;
  for (int round = 0; round < rounds; ++round) {
    solve(joints,
          {step, speed, vehicle.mode.max_ascent, vehicle.mode.max_descent, vehicle.mode.jerk},
          wall_cost);
    Curve curve = curve_through(joints, step);
    const double factor = needed_slowdown(curve, motion);
    curve = slowed(std::move(curve), factor);
    if (!best.empty() && duration(curve) > duration(best)) break;
    best = std::move(curve);
    step *= std::clamp(factor, 0.8, 1.0) * haste;
  }
  return best;
}

}  // namespace skycap::flight
