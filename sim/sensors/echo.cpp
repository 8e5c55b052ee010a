#include "sim/sensors/echo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace skycap::sim {
namespace {

constexpr double speed_of_light = 299'792'458.0;

Echo merge(std::span<const RayHit> hits, const Sensitivity& sensitivity) {
  Echo echo = {};
  double weighted_range = 0.0, weight = 0.0;
  float strongest = -1.0F;
  for (const RayHit& hit : hits) {
    const float energy = hit.share * hit.reflectance * hit.cosine;
    weighted_range += static_cast<double>(energy) * hit.range;
    weight += energy;
    echo.intensity += energy;
    echo.power += received_power(hit, sensitivity);
    if (energy <= strongest) continue;
    strongest = energy;
    echo.cosine = hit.cosine;
    echo.triangle = hit.triangle;
  }
  echo.range = weight > 0.0 ? static_cast<float>(weighted_range / weight) : hits.front().range;
  return echo;
}

// Keeps the echoes that the sensor reports, in the order of their ranges.
void choose(std::vector<Echo>& echoes, const Beam& beam) {
  const auto max = static_cast<std::size_t>(beam.max_returns);
  if (echoes.size() <= max) return;
  if (beam.choice == EchoChoice::first) {
    echoes.resize(max);
    return;
  }
  if (beam.choice == EchoChoice::last) {
    echoes.erase(echoes.begin(), echoes.end() - beam.max_returns);
    return;
  }
  const auto is_weaker = [](const Echo& a, const Echo& b) { return a.power < b.power; };
  const bool keeps_last = beam.choice == EchoChoice::strongest_and_last && max > 1;
  while (echoes.size() > max) {
    const auto end = keeps_last ? echoes.end() - 1 : echoes.end();
    echoes.erase(std::min_element(echoes.begin(), end, is_weaker));
  }
}

}  // namespace

float received_power(const RayHit& hit, const Sensitivity& sensitivity) {
  if (sensitivity.reference_range <= 0.0) return std::numeric_limits<float>::infinity();
  const double nearness = sensitivity.reference_range / hit.range;
  const double clear = hit.share * hit.reflectance * hit.cosine * nearness * nearness /
                       sensitivity.reference_reflectance;
  return static_cast<float>(sensitivity.attenuation > 0.0
                                ? clear * std::exp(-2.0 * sensitivity.attenuation * hit.range)
                                : clear);
}

std::vector<Echo> form_echoes(std::span<RayHit> hits, const Sensitivity& sensitivity,
                              const Beam& beam, std::vector<Echo> buffer) {
  std::vector<Echo> echoes = std::move(buffer);
  echoes.clear();
  if (hits.empty()) return echoes;
  const auto by_range = [](const RayHit& a, const RayHit& b) { return a.range < b.range; };
  const auto resolution = static_cast<float>(0.5 * speed_of_light * beam.pulse_length);
  const auto [nearest, farthest] = std::minmax_element(hits.begin(), hits.end(), by_range);
  const bool is_single = farthest->range - nearest->range < resolution;  // Usual case.
  if (!is_single) std::sort(hits.begin(), hits.end(), by_range);
  for (std::size_t first = 0; first < hits.size();) {
    std::size_t end = is_single ? hits.size() : first + 1;
    while (end < hits.size() && hits[end].range - hits[end - 1].range < resolution) ++end;
    const Echo echo = merge(hits.subspan(first, end - first), sensitivity);
    if (echo.power >= 1.0F) echoes.push_back(echo);
    first = end;
  }
  choose(echoes, beam);
  return echoes;
}

float range_sigma(const RangeErrors& errors, float range, float cosine, float reflectance) {
  if (errors.table.is_on()) return errors.table.sigma(range, cosine, reflectance);
  const double linear = errors.sigma_per_metre * range;
  const double quadratic = errors.sigma_per_square_metre * range * range;
  double sigma = std::sqrt(errors.sigma * errors.sigma + linear * linear + quadratic * quadratic);
  if (errors.incidence_power > 0.0) {
    constexpr double grazing = 1e-3;  // Keeps the error finite.
    sigma /= std::pow(std::max<double>(cosine, grazing), errors.incidence_power);
  }
  return static_cast<float>(sigma);
}

std::vector<BeamSample> beam_samples(int rings) {
  std::vector<BeamSample> samples = {{0.0F, 0.0F, 1.0F}};
  float total = 1.0F;
  for (int ring = 1; ring <= rings; ++ring) {
    const double radius = static_cast<double>(ring) / rings;
    const auto weight = static_cast<float>(std::exp(-2.0 * radius * radius));
    for (int i = 0; i < 6 * ring; ++i) {
      const double angle = std::numbers::pi * (i + 0.5) / (3.0 * ring);
      samples.push_back({static_cast<float>(radius * std::cos(angle)),
                         static_cast<float>(radius * std::sin(angle)), weight});
      total += weight;
    }
  }
  for (BeamSample& sample : samples) sample.share /= total;
  return samples;
}

}  // namespace skycap::sim
