#include "sim/sensors/noise_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/error.h"

namespace skycap::sim {
namespace {

/// Position on an axis: entry and fraction of the way to the next one.
struct AxisPosition {
  std::size_t entry = 0;
  double share = 0.0;
};

AxisPosition find_on_axis(const std::vector<double>& axis, double value) {
  if (!(value > axis.front()) || axis.size() == 1) return {};
  if (value >= axis.back()) return {axis.size() - 2, 1.0};
  const auto after = std::upper_bound(axis.begin(), axis.end(), value);
  const auto entry = static_cast<std::size_t>(after - axis.begin()) - 1;
  return {entry, (value - axis[entry]) / (axis[entry + 1] - axis[entry])};
}

[[noreturn]] void reject_table(const std::string& what) {
  throw Error(ErrorKind::bad_config, what);
}

void validate_axis(const std::vector<double>& axis, const std::string& name, double min,
                   double max) {
  if (axis.empty()) reject_table(name + " must list at least one value");
  for (std::size_t i = 0; i < axis.size(); ++i) {
    if (!(axis[i] >= min && axis[i] <= max)) {
      reject_table(name + " contains " + std::to_string(axis[i]) + "; it must be between " +
                   std::to_string(min) + " and " + std::to_string(max));
    }
    if (i > 0 && axis[i] <= axis[i - 1]) reject_table(name + " must be in ascending order");
  }
}

}  // namespace

float NoiseTable::sigma(double range, double cosine, double reflectance) const {
  const double angle = std::acos(std::clamp(cosine, 0.0, 1.0));
  const AxisPosition at_range = find_on_axis(ranges, range),
                     at_angle = find_on_axis(incidences, angle),
                     at_reflectance = find_on_axis(reflectances, reflectance);
  double sum = 0.0;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    const auto entry = [&](const AxisPosition& position, bool is_next) {
      weight *= is_next ? position.share : 1.0 - position.share;
      return position.entry + (is_next ? 1 : 0);
    };
    const std::size_t i = entry(at_range, (corner & 1) != 0),
                      j = entry(at_angle, (corner & 2) != 0),
                      k = entry(at_reflectance, (corner & 4) != 0);
    if (weight == 0.0) continue;
    sum += weight * sigmas[(i * incidences.size() + j) * reflectances.size() + k];
  }
  return static_cast<float>(sum);
}

void NoiseTable::validate(const std::string& name) const {
  if (!is_on()) return;
  constexpr double max_range = 1e6, max_sigma = 1e3;
  validate_axis(ranges, name + ".range", 0.0, max_range);
  validate_axis(incidences, name + ".incidence", 0.0, std::numbers::pi / 2.0);
  validate_axis(reflectances, name + ".reflectance", 0.0, 1.0);
  const std::size_t count = ranges.size() * incidences.size() * reflectances.size();
  if (sigmas.size() != count) {
    reject_table(name + ".sigma lists " + std::to_string(sigmas.size()) +
                 " values; it must list one for each combination of range, incidence and "
                 "reflectance: " +
                 std::to_string(count));
  }
  for (const double sigma : sigmas) {
    if (sigma >= 0.0 && sigma <= max_sigma) continue;
    reject_table(name + ".sigma contains " + std::to_string(sigma) +
                 "; it must be between 0 and 1000 m");
  }
}

}  // namespace skycap::sim
