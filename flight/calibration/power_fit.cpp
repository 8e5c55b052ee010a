#include "flight/calibration/power_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Dense>

#include "flight/motion/motion.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double window_time = 2.0;       ///< [s]
constexpr double longest_gap = 0.5;       ///< between samples of a window [s]
constexpr double steady = 0.5;            ///< change of velocity within a window [m/s]
constexpr double share_in_the_air = 0.5;  ///< of the usual power

/// Logarithms of endurance, avionics' power and drag area, which are positive; wind east and north.
using Unknowns = Eigen::Matrix<double, 5, 1>;

constexpr double least_avionics = 0.1, least_drag = 1e-4;

/// A step that would change one of them by more is shortened: far off, the model is so flat that
/// the fit would stay there.
const Unknowns longest_step = (Unknowns() << 0.5, 0.5, 0.5, 2.0, 2.0).finished();

Unknowns unknowns_of(const Vehicle& vehicle) {
  Unknowns x = Unknowns::Zero();
  x[0] = std::log(vehicle.endurance_min);
  x[1] = std::log(std::max(least_avionics, vehicle.avionics_power));
  x[2] = std::log(std::max(least_drag, vehicle.drag_area));
  return x;
}

PowerFit fit_of(const Unknowns& x, Vehicle vehicle) {
  vehicle.endurance_min = std::exp(x[0]);
  vehicle.avionics_power = std::exp(x[1]);
  vehicle.drag_area = std::exp(x[2]);
  return {vehicle, {x[3], x[4]}};
}

Motion motion_of(const PowerFit& fit, double air_density) {
  Conditions conditions;
  conditions.wind = fit.wind;
  conditions.air_density = air_density;
  conditions.cruise_speed = std::min(conditions.cruise_speed, fit.vehicle.max_speed);
  return {fit.vehicle, conditions};
}

double mean_power(const Motion& motion, const LogWindow& window) {
  double sum = 0.0;
  for (const Vector3d& velocity : window.velocities) sum += motion.flight_power(velocity);
  return sum / static_cast<double>(window.velocities.size());
}

/// How far off the model is in each window; nothing if no vehicle is like that.
std::optional<Eigen::VectorXd> errors_of(const Unknowns& x, std::span<const LogWindow> windows,
                                         const Vehicle& vehicle, double air_density) {
  try {
    const Motion motion = motion_of(fit_of(x, vehicle), air_density);
    Eigen::VectorXd errors(static_cast<Eigen::Index>(windows.size()));
    for (std::size_t i = 0; i < windows.size(); ++i) {
      errors[static_cast<Eigen::Index>(i)] = mean_power(motion, windows[i]) - windows[i].power;
    }
    return errors;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

std::vector<LogWindow> windows_of(const std::vector<LogSample>& samples) {
  std::vector<double> powers;
  for (const LogSample& sample : samples) powers.push_back(sample.power);
  const auto usual = powers.begin() + static_cast<std::ptrdiff_t>(powers.size() * 3 / 4);
  std::nth_element(powers.begin(), usual, powers.end());
  const double in_the_air = share_in_the_air * *usual;

  std::vector<LogWindow> windows;
  for (std::size_t begin = 0; begin < samples.size();) {
    LogWindow window;
    std::size_t end = begin;
    double energy = 0.0;
    for (; end + 1 < samples.size() && window.duration < window_time; ++end) {
      const double gap = samples[end + 1].time - samples[end].time;
      if (gap > longest_gap || samples[end].power < in_the_air) break;
      window.velocities.push_back(samples[end].velocity);
      window.duration += gap;
      energy += gap * samples[end].power;
    }
    const double change = (samples[end].velocity - samples[begin].velocity).norm();
    if (window.duration >= window_time && change < steady) {
      window.power = energy / window.duration;
      windows.push_back(std::move(window));
    }
    begin = std::max(end, begin + 1);
  }
  return windows;
}

double modelled_power(const PowerFit& fit, const LogWindow& window, double air_density) {
  return mean_power(motion_of(fit, air_density), window);
}

// Levenberg-Marquardt with forward differences (Madsen, Nielsen & Tingleff 2004, section 3.2).
PowerFit fit_power(std::span<const LogWindow> windows, const Vehicle& vehicle, double air_density) {
  constexpr int most_steps = 100;
  constexpr double difference = 1e-5, enough = 1e-10;
  const auto errors_at = [&](const Unknowns& x) {
    return errors_of(x, windows, vehicle, air_density);
  };
  Unknowns x = unknowns_of(vehicle);
  std::optional<Eigen::VectorXd> errors = errors_at(x);
  if (!errors) throw Error(ErrorKind::bad_config, "the vehicle's own figures do not go together");
  double damping = 1e-3;
  for (int i = 0; i < most_steps && damping < 1e12; ++i) {
    Eigen::MatrixXd slope(errors->size(), x.size());
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      Unknowns moved = x;
      moved[k] += difference;
      const auto there = errors_at(moved);
      slope.col(k) = there ? Eigen::VectorXd((*there - *errors) / difference)
                           : Eigen::VectorXd::Zero(errors->size());
    }
    Eigen::Matrix<double, 5, 5> normal = slope.transpose() * slope;
    normal.diagonal() += damping * (normal.diagonal().array() + 1e-6).matrix();
    Unknowns step = -normal.ldlt().solve(slope.transpose() * *errors);
    step /= std::max(1.0, step.cwiseAbs().cwiseQuotient(longest_step).maxCoeff());
    const auto next = errors_at(x + step);
    if (!next || next->squaredNorm() >= errors->squaredNorm()) {
      damping *= 4.0;
      continue;
    }
    const double gained = errors->squaredNorm() - next->squaredNorm();
    x += step;
    errors = next;
    damping *= 0.25;
    if (gained < enough * errors->squaredNorm()) break;
  }
  return fit_of(x, vehicle);
}

}  // namespace skycap::flight
