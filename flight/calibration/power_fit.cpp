#include "flight/calibration/power_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "flight/motion/hover_power.h"
#include "flight/motion/motion.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double window_time = 2.0;       ///< Duration of a window [s].
constexpr double longest_gap = 0.5;       ///< Maximum interval between samples of a window [s].
constexpr double steady = 0.5;            ///< Maximum velocity change within a window [m/s].
constexpr double share_in_the_air = 0.5;  ///< Minimum power in the air, relative to the median.
constexpr double hover_speed = 0.5;       ///< Maximum speed of hovering [m/s].

/// Outlier limits relative to neighbouring readings. An outlier exceeds this number of median
/// absolute deviations and the tolerance.
constexpr double max_deviations = 6.0, power_tolerance = 0.3 /* of the median */,
                 velocity_tolerance = 1.0 /* [m/s] */;
constexpr std::size_t neighbours = 5;   ///< Number of neighbours on each side.
constexpr double neighbour_time = 1.0;  ///< Maximum time to a neighbour [s].

/// Unknowns: rotor power in hover at sea level [W], avionics power [W], product of rotor power and
/// drag area [W m^2], wind east and north [m/s]. The model is linear in them for a fixed wind.
using Unknowns = std::array<double, 5>;
constexpr std::size_t rotors = 0, avionics = 1, drag = 2, wind_east = 3, wind_north = 4;

/// Relative margin above the minimum rotor power, which survives the rounding of written values.
constexpr double rotor_margin = 1e-4;
/// Lower bound of the fit, relative to the minimum rotor power. The fit may use values below the
/// minimum. Hover power and wind are then right even if mass or rotors differ from the actual ones.
constexpr double min_rotor_fraction = 0.05;
constexpr double min_avionics = 1e-3, min_drag = 1e-6;

/// Weight of wind [W per m/s]. It is far smaller than the evidence of a log flown in several
/// directions. Its effect is zero wind where the log contains no evidence.
constexpr double wind_weight = 1.0;

/// Huber threshold in robust standard deviations.
constexpr double huber_deviations = 2.0;
/// Lower bound of that deviation, relative to the hover power.
constexpr double min_deviation = 0.005;
constexpr int reweightings = 3;

/// Weight of hover windows. If the model cannot fit everywhere, such as with a parameter at its
/// bound, it must fit in hover, which determines the endurance.
constexpr double hover_weight = 10.0;

/// Returns the means of groups of consecutive velocities, which hardly change within a window.
std::vector<Vector3d> compute_means(const std::vector<Vector3d>& velocities) {
  constexpr std::size_t together = 5;
  std::vector<Vector3d> means;
  for (std::size_t i = 0; i < velocities.size(); i += together) {
    const std::size_t end = std::min(velocities.size(), i + together);
    Vector3d sum = Vector3d::Zero();
    for (std::size_t k = i; k < end; ++k) sum += velocities[k];
    means.push_back(sum / static_cast<double>(end - i));
  }
  return means;
}

/// Returns true if a value exceeds both the spread of its neighbours and the tolerance, which
/// depends on their median.
template <class Tolerance>
bool is_outlier(double value, const std::vector<double>& around, const Tolerance& tolerance) {
  const double middle = median(around);
  std::vector<double> deviations;
  for (const double other : around) deviations.push_back(std::abs(other - middle));
  return std::abs(value - middle) >
         std::max(tolerance(middle), max_deviations * median(deviations));
}

double lower_rotor_bound(const Vehicle& vehicle) {
  return (1.0 + rotor_margin) * min_rotor_power(vehicle);
}

PowerFit make_fit(const Unknowns& x, Vehicle vehicle) {
  vehicle.endurance_min = endurance_at(vehicle, x[rotors] + x[avionics]);
  vehicle.avionics_power = x[avionics];
  vehicle.drag_area = x[drag] / x[rotors];
  return {vehicle, {x[wind_east], x[wind_north]}, {}};
}

Motion make_motion(const Vehicle& vehicle, const Eigen::Vector2d& wind, double air_density) {
  Conditions conditions;
  conditions.wind = wind;
  conditions.air_density = air_density;
  conditions.cruise_speed = std::min(conditions.cruise_speed, vehicle.max_speed);
  return {vehicle, conditions};
}

double mean_power(const Motion& motion, const LogWindow& window) {
  double sum = 0.0;
  for (const Vector3d& velocity : window.velocities) sum += motion.flight_power(velocity);
  return sum / static_cast<double>(window.velocities.size());
}

/// Basis functions of the linear model for one wind.
class Basis {
 public:
  Basis(Vehicle vehicle, const Eigen::Vector2d& wind, double air_density) {
    rotor_power_ = 2.0 * min_rotor_power(vehicle);  // Any feasible value.
    vehicle.avionics_power = 0.0;
    vehicle.endurance_min = endurance_at(vehicle, rotor_power_);
    vehicle.drag_area = 0.0;
    without_drag_.emplace(make_motion(vehicle, wind, air_density));
    vehicle.drag_area = 1.0;
    with_drag_.emplace(make_motion(vehicle, wind, air_density));
  }

  /// Returns the rotor power in a window relative to hover, and the effect of one unit of `drag`
  /// [1/m^2].
  std::array<double, 2> of(const LogWindow& window) const {
    const double without = mean_power(*without_drag_, window);
    return {without / rotor_power_, (mean_power(*with_drag_, window) - without) / rotor_power_};
  }

 private:
  double rotor_power_ = 0.0;
  std::optional<Motion> without_drag_, with_drag_;
};

double compute_power(const Unknowns& x, const std::array<double, 2>& basis) {
  return x[avionics] + x[rotors] * basis[0] + x[drag] * basis[1];
}

bool is_hover(const LogWindow& window) {
  return std::ranges::all_of(window.velocities,
                             [](const Vector3d& v) { return v.norm() < hover_speed; });
}

struct Problem {
  std::span<const LogWindow> windows;
  const Vehicle& vehicle;
  double air_density;
  const std::vector<double>& weights;

  /// Throws an Error if the vehicle cannot fly in such wind.
  Basis basis(double east, double north) const { return {vehicle, {east, north}, air_density}; }
};

/// Weighted errors of all windows and of the wind [W]. Derivatives are exact for linear unknowns
/// and central differences for the wind.
class Errors final : public ceres::CostFunction {
 public:
  explicit Errors(const Problem& problem) : problem_(problem) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(Unknowns{}.size()));
    set_num_residuals(static_cast<int>(problem.windows.size()) + 2);
  }

  bool Evaluate(double const* const* parameters, double* errors,
                double** jacobians) const override {
    Unknowns x;
    std::copy_n(parameters[0], x.size(), x.begin());
    const auto& windows = problem_.windows;
    try {
      const Basis basis = problem_.basis(x[wind_east], x[wind_north]);
      double* const rows = jacobians != nullptr ? jacobians[0] : nullptr;
      for (std::size_t i = 0; i < windows.size(); ++i) {
        const double weight = problem_.weights[i];
        const std::array<double, 2> parts = basis.of(windows[i]);
        errors[i] = weight * (compute_power(x, parts) - windows[i].power);
        if (rows == nullptr) continue;
        double* const row = rows + i * x.size();
        row[rotors] = weight * parts[0];
        row[avionics] = weight;
        row[drag] = weight * parts[1];
      }
      if (rows != nullptr) {
        add_wind(x, wind_east, rows);
        add_wind(x, wind_north, rows);
      }
    } catch (const Error&) {
      return false;
    }
    errors[windows.size()] = wind_weight * x[wind_east];
    errors[windows.size() + 1] = wind_weight * x[wind_north];
    return true;
  }

 private:
  void add_wind(const Unknowns& x, std::size_t axis, double* rows) const {
    constexpr double step = 1e-4;  // Step of the differences [m/s].
    Unknowns less = x, more = x;
    less[axis] -= step;
    more[axis] += step;
    const Basis before = problem_.basis(less[wind_east], less[wind_north]);
    const Basis after = problem_.basis(more[wind_east], more[wind_north]);
    const std::size_t count = problem_.windows.size();
    for (std::size_t i = 0; i < count; ++i) {
      const LogWindow& window = problem_.windows[i];
      const double change =
          compute_power(x, after.of(window)) - compute_power(x, before.of(window));
      rows[i * x.size() + axis] = problem_.weights[i] * change / (2.0 * step);
    }
    for (const std::size_t of : {wind_east, wind_north}) {
      double* const row = rows + (count + of - wind_east) * x.size();
      row[rotors] = row[avionics] = row[drag] = 0.0;
      row[axis] = of == axis ? wind_weight : 0.0;
    }
  }

  const Problem& problem_;
};

/// Solves one weighted least-squares problem within the bounds, starting at `x`.
Unknowns solved(Unknowns x, const Problem& problem) {
  ceres::Problem fit;
  fit.AddResidualBlock(std::make_unique<Errors>(problem).release(), nullptr, x.data());
  fit.SetParameterLowerBound(x.data(), rotors,
                             min_rotor_fraction * min_rotor_power(problem.vehicle));
  fit.SetParameterLowerBound(x.data(), avionics, min_avionics);
  fit.SetParameterLowerBound(x.data(), drag, min_drag);
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
  ceres::Solve(options, &fit, &summary);
  if (!summary.IsSolutionUsable()) {
    throw Error(ErrorKind::bad_file, "no power model fits the log (" + summary.message + ")");
  }
  return x;
}

/// Computes Huber weights of the window errors, with a deviation from their median.
void reweight(std::vector<double>& weights, const Problem& problem, const Unknowns& x) {
  const Basis basis = problem.basis(x[wind_east], x[wind_north]);
  std::vector<double> errors;
  for (const LogWindow& window : problem.windows) {
    errors.push_back(std::abs(compute_power(x, basis.of(window)) - window.power));
  }
  constexpr double normal = 1.4826;  // Standard deviations per median absolute deviation.
  const double deviation =
      std::max(normal * median(errors), min_deviation * (x[rotors] + x[avionics]));
  for (std::size_t i = 0; i < errors.size(); ++i) {
    weights[i] = std::sqrt(std::min(1.0, huber_deviations * deviation / errors[i]));
  }
}

/// Returns the nearest feasible solution with the same wind and hover power: minimum rotor power,
/// and the best drag for it.
Unknowns with_possible_rotors(Unknowns x, const Problem& problem) {
  const double min = lower_rotor_bound(problem.vehicle);
  if (x[rotors] >= min) return x;
  x[avionics] = std::max(min_avionics, x[rotors] + x[avionics] - min);
  x[rotors] = min;
  x[drag] = 0.0;
  const Basis basis = problem.basis(x[wind_east], x[wind_north]);
  double products = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < problem.windows.size(); ++i) {
    const LogWindow& window = problem.windows[i];
    const std::array<double, 2> parts = basis.of(window);
    const double weight = problem.weights[i] * problem.weights[i];
    products += weight * parts[1] * (window.power - compute_power(x, parts));
    squares += weight * parts[1] * parts[1];
  }
  x[drag] = std::max(min_drag * x[rotors], squares > 0.0 ? products / squares : 0.0);
  return x;
}

std::vector<std::string> bounds_met(const Unknowns& x, const Vehicle& vehicle) {
  std::vector<std::string> met;
  if (x[rotors] <= lower_rotor_bound(vehicle)) met.emplace_back("rotors");
  if (x[avionics] < 2.0 * min_avionics) met.emplace_back("avionics_power");
  if (x[drag] < 2.0 * min_drag * x[rotors]) met.emplace_back("drag_area");
  return met;
}

}  // namespace

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<LogSample> without_outliers(const std::vector<LogSample>& samples) {
  std::vector<LogSample> kept;
  std::vector<double> around;
  const auto is_alone = [&](std::size_t i, const auto& get_value, const auto& tolerance) {
    around.clear();
    const std::size_t begin = i - std::min(i, neighbours);
    const std::size_t end = std::min(samples.size(), i + neighbours + 1);
    for (std::size_t k = begin; k < end; ++k) {
      if (k == i || std::abs(samples[k].time - samples[i].time) > neighbour_time) continue;
      around.push_back(get_value(samples[k]));
    }
    constexpr std::size_t enough = 4;
    return around.size() >= enough && is_outlier(get_value(samples[i]), around, tolerance);
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

std::vector<LogWindow> find_windows(const std::vector<LogSample>& samples) {
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
      window.velocities = compute_means(window.velocities);
      windows.push_back(std::move(window));
    }
    begin = std::max(end, begin + 1);
  }
  return windows;
}

double modelled_power(const PowerFit& fit, const LogWindow& window, double air_density) {
  return mean_power(make_motion(fit.vehicle, fit.wind, air_density), window);
}

PowerFit fit_power(std::span<const LogWindow> windows, const Vehicle& vehicle, double air_density,
                   double hover_power) {
  constexpr double inside = 1.02;
  Unknowns x{};
  x[rotors] = std::max(inside * lower_rotor_bound(vehicle), hover_power - vehicle.avionics_power);
  x[avionics] = std::max(2.0 * min_avionics, hover_power - x[rotors]);
  x[drag] = x[rotors] * std::max(2.0 * min_drag, vehicle.drag_area);
  std::vector<double> weights(windows.size(), 1.0);
  const Problem problem{windows, vehicle, air_density, weights};
  for (int i = 0; i < reweightings; ++i) {
    x = solved(x, problem);
    reweight(weights, problem, x);
  }
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (is_hover(windows[i])) weights[i] *= hover_weight;
  }
  x = with_possible_rotors(solved(x, problem), problem);
  PowerFit fit = make_fit(x, vehicle);
  fit.at_bound = bounds_met(x, vehicle);
  return fit;
}

}  // namespace skycap::flight
