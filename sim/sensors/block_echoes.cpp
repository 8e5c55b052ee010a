#include "sim/sensors/block_echoes.h"

#include <utility>

namespace skycap::sim {
namespace {

RayHit hit(const Hits& hits, std::size_t ray, float share, const Scene& scene) {
  return {hits.range[ray], hits.cosine[ray], scene.reflectance(hits.triangle[ray]), share,
          hits.triangle[ray]};
}

}  // namespace

void EchoRow::resize(std::size_t slots) {
  range.resize(slots);
  cosine.resize(slots);
  intensity.resize(slots);
  triangle.resize(slots);
}

void BlockEchoes::find_ray_echoes(Hits& hits, const Scene& scene, const LidarConfig& config) {
  const std::size_t slots = hits.range.size();
  const auto min_range = static_cast<float>(config.min_range);
  EchoRow& row = rows[0];
  row.resize(slots);
  counts.resize(slots);
  for (std::size_t slot = 0; slot < slots; ++slot) {
    counts[slot] = hits.range[slot] >= min_range ? 1 : 0;
    row.intensity[slot] = Scene::default_reflectance * hits.cosine[slot];
  }
  const bool is_graded = config.sensitivity.reference_range > 0.0 || scene.has_reflectances();
  for (std::size_t slot = 0; slot < slots && is_graded; ++slot) {
    if (counts[slot] == 0) continue;
    const RayHit only = hit(hits, slot, 1.0F, scene);
    row.intensity[slot] = only.reflectance * only.cosine;
    counts[slot] = received_power(only, config.sensitivity) >= 1.0F ? 1 : 0;
  }
  std::swap(row.range, hits.range);
  std::swap(row.cosine, hits.cosine);
  std::swap(row.triangle, hits.triangle);
}

void BlockEchoes::find_beam_echoes(const Hits& hits, std::span<const BeamSample> beam,
                                   const Scene& scene, const LidarConfig& config) {
  const std::size_t samples = beam.size(), slots = hits.range.size() / samples;
  const auto min_range = static_cast<float>(config.min_range);
  for (EchoRow& row : rows) row.resize(slots);
  counts.resize(slots);
  beam_hits_.resize(samples);
  for (std::size_t slot = 0; slot < slots; ++slot) {
    std::size_t found = 0;
    for (std::size_t i = 0, ray = slot * samples; i < samples; ++i, ++ray) {
      if (hits.range[ray] < min_range) continue;
      beam_hits_[found++] = hit(hits, ray, beam[i].share, scene);
    }
    echoes_ = form_echoes({beam_hits_.data(), found}, config.sensitivity, config.beam,
                          std::move(echoes_));
    counts[slot] = static_cast<int>(echoes_.size());
    for (std::size_t i = 0; i < echoes_.size(); ++i) {
      EchoRow& row = rows[i];
      row.range[slot] = echoes_[i].range;
      row.cosine[slot] = echoes_[i].cosine;
      row.intensity[slot] = echoes_[i].intensity;
      row.triangle[slot] = echoes_[i].triangle;
    }
  }
}

}  // namespace skycap::sim
