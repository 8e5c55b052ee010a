#include "flight/calibration/power_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <ceres/dynamic_numeric_diff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "flight/motion/hover_power.h"
#include "flight/motion/motion.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double window_time = 2.0;       ///< [s]
constexpr double longest_gap = 0.5;       ///< between samples of a window [s]
constexpr double steady = 0.5;            ///< change of velocity within a window [m/s]
constexpr double share_in_the_air = 0.5;  ///< of the usual power
constexpr double hover_speed = 0.5;       ///< [m/s]

/// Of a reading among its neighbours: deviations beyond so many median absolute deviations, and
/// beyond these bounds, are damage.
constexpr double most_deviations = 6.0, power_tolerance = 0.3 /* of the median */,
                 velocity_tolerance = 1.0 /* [m/s] */;
constexpr std::size_t neighbours = 5;   ///< on each side
constexpr double neighbour_time = 1.0;  ///< [s]

/// Power of the rotors in hover at sea level [W], avionics' power [W], drag area [m^2], wind east
/// and north [m/s].
using Unknowns = std::array<double, 5>;
constexpr std::size_t rotors = 0, avionics = 1, drag = 2, wind_east = 3, wind_north = 4;

/// Above the rotors' least power by a share that rounding of the written figures keeps.
constexpr double rotor_margin = 1e-4;
constexpr double least_avionics = 1e-3, least_drag = 1e-6;

/// Windows beyond so many robust standard deviations count less and less.
constexpr double huber_deviations = 2.0;
/// That deviation is at least this share of the hover power.
constexpr double least_deviation = 0.005;
constexpr int reweightings = 3;

/// Where the model cannot be right everywhere, as where a figure is at its bound, it shall be right
/// in hover, which decides the endurance: those errors count so many times as much.
constexpr double hover_weight = 10.0;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Whether a value is beyond its neighbours' spread and the tolerance, which is for values about
/// their median.
template <class Tolerance>
bool is_outlier(double value, const std::vector<double>& around, const Tolerance& tolerance) {
  const double middle = median(around);
  std::vector<double> deviations;
  for (const double other : around) deviations.push_back(std::abs(other - middle));
  return std::abs(value - middle) >
         std::max(tolerance(middle), most_deviations * median(deviations));
}

PowerFit fit_of(const Unknowns& x, Vehicle vehicle) {
  vehicle.endurance_min = endurance_at(vehicle, x[rotors] + x[avionics]);
  vehicle.avionics_power = x[avionics];
  vehicle.drag_area = x[drag];
  return {vehicle, {x[wind_east], x[wind_north]}, {}};
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

bool is_hover(const LogWindow& window) {
  return std::ranges::all_of(window.velocities,
                             [](const Vector3d& v) { return v.norm() < hover_speed; });
}

/// The weighted errors of all windows [W].
struct Errors {
  std::span<const LogWindow> windows;
  const Vehicle& vehicle;
  double air_density;
  const std::vector<double>& weights;

  /// False if no vehicle is like that.
  bool operator()(double const* const* parameters, double* errors) const {
    Unknowns x;
    std::copy_n(parameters[0], x.size(), x.begin());
    try {
      const Motion motion = motion_of(fit_of(x, vehicle), air_density);
      for (std::size_t i = 0; i < windows.size(); ++i) {
        errors[i] = weights[i] * (mean_power(motion, windows[i]) - windows[i].power);
      }
      return true;
    } catch (const Error&) {
      return false;
    }
  }
};

/// One weighted least-squares fit within the bounds, from `x` on.
Unknowns solved(Unknowns x, const Errors& errors) {
  ceres::Problem problem;
  auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<Errors, ceres::CENTRAL>>(
      new Errors(errors));
  cost->AddParameterBlock(static_cast<int>(x.size()));
  cost->SetNumResiduals(static_cast<int>(errors.windows.size()));
  problem.AddResidualBlock(cost.release(), nullptr, x.data());
  problem.SetParameterLowerBound(x.data(), rotors,
                                 (1.0 + rotor_margin) * min_rotor_power(errors.vehicle));
  problem.SetParameterLowerBound(x.data(), avionics, least_avionics);
  problem.SetParameterLowerBound(x.data(), drag, least_drag);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.dense_linear_algebra_library_type = ceres::EIGEN;
  options.num_threads = 1;
  options.max_num_iterations = 60;
  options.max_num_consecutive_invalid_steps = 20;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    throw Error(ErrorKind::bad_file, "no power model fits the log (" + summary.message + ")");
  }
  return x;
}

/// Huber's weights of the windows' errors, whose deviation is by their median.
void reweight(std::vector<double>& weights, std::span<const LogWindow> windows, const PowerFit& fit,
              double air_density) {
  const Motion motion = motion_of(fit, air_density);
  std::vector<double> errors;
  for (const LogWindow& window : windows) {
    errors.push_back(std::abs(mean_power(motion, window) - window.power));
  }
  constexpr double normal = 1.4826;  // standard deviations in a median absolute deviation
  const double deviation =
      std::max(normal * median(errors), least_deviation * data_sheet_power(fit.vehicle));
  for (std::size_t i = 0; i < errors.size(); ++i) {
    weights[i] = std::sqrt(std::min(1.0, huber_deviations * deviation / errors[i]));
  }
}

std::vector<std::string> bounds_met(const Unknowns& x, const Vehicle& vehicle) {
  std::vector<std::string> met;
  if (x[rotors] < (1.0 + 2.0 * rotor_margin) * min_rotor_power(vehicle)) met.emplace_back("rotors");
  if (x[avionics] < 2.0 * least_avionics) met.emplace_back("avionics_power");
  if (x[drag] < 2.0 * least_drag) met.emplace_back("drag_area");
  return met;
}

}  // namespace

std::vector<LogSample> without_outliers(const std::vector<LogSample>& samples) {
  std::vector<LogSample> kept;
  std::vector<double> around;
  const auto is_alone = [&](std::size_t i, const auto& value_of, const auto& tolerance) {
    around.clear();
    const std::size_t begin = i - std::min(i, neighbours);
    const std::size_t end = std::min(samples.size(), i + neighbours + 1);
    for (std::size_t k = begin; k < end; ++k) {
      if (k == i || std::abs(samples[k].time - samples[i].time) > neighbour_time) continue;
      around.push_back(value_of(samples[k]));
    }
    constexpr std::size_t enough = 4;
    return around.size() >= enough && is_outlier(value_of(samples[i]), around, tolerance);
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    bool is_kept = !is_alone(
        i, [](const LogSample& s) { return s.power; },
        [](double middle) { return power_tolerance * std::abs(middle); });
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      is_kept = is_kept && !is_alone(
                               i, [&](const LogSample& s) { return s.velocity[axis]; },
                               [](double) { return velocity_tolerance; });
    }
    if (is_kept) kept.push_back(samples[i]);
  }
  return kept;
}

std::vector<LogWindow> windows_of(const std::vector<LogSample>& samples) {
  if (samples.empty()) return {};
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

PowerFit fit_power(std::span<const LogWindow> windows, const Vehicle& vehicle, double air_density,
                   double hover_power) {
  const double least = (1.0 + rotor_margin) * min_rotor_power(vehicle);
  constexpr double inside = 1.02;
  Unknowns x{};
  x[rotors] = std::max(inside * least, hover_power - vehicle.avionics_power);
  x[avionics] = std::max(2.0 * least_avionics, hover_power - x[rotors]);
  x[drag] = std::max(2.0 * least_drag, vehicle.drag_area);
  std::vector<double> weights(windows.size(), 1.0);
  const Errors errors{windows, vehicle, air_density, weights};
  for (int i = 0; i < reweightings; ++i) {
    x = solved(x, errors);
    reweight(weights, windows, fit_of(x, vehicle), air_density);
  }
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (is_hover(windows[i])) weights[i] *= hover_weight;
  }
  x = solved(x, errors);
  PowerFit fit = fit_of(x, vehicle);
  fit.at_bound = bounds_met(x, vehicle);
  return fit;
}

}  // namespace skycap::flight
