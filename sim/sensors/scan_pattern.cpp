#include "sim/sensors/scan_pattern.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/scene/four_lanes.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

constexpr double turn = 2.0 * std::numbers::pi;

// Returns the angle of a rotation at constant rate. Exact even after days.
double turned(double rate, double time) {
  const double turns = rate * time;
  return turn * (turns - std::floor(turns));
}

// Returns the refracted direction according to Snell's law in vector form. `normal` is a unit
// vector against the beam. `ratio` is the refractive index before the face divided by that behind
// it.
Vector3d refract_at_face(const Vector3d& beam, const Vector3d& normal, double ratio) {
  const double cosine = -beam.dot(normal);
  const double squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
  return ratio * beam + (ratio * cosine - std::sqrt(std::max(0.0, squared))) * normal;
}

}  // namespace

Vector3d refract(const std::vector<WedgePrism>& prisms, double time, Vector3d beam) {
  for (const WedgePrism& prism : prisms) {
    const double angle = prism.phase + turned(prism.rotation_rate, time);
    const double sine = prism.is_inclined_at_entry ? std::sin(prism.wedge) : -std::sin(prism.wedge);
    const Vector3d inclined(-std::cos(prism.wedge), sine * std::cos(angle), sine * std::sin(angle));
    const Vector3d square = -Vector3d::UnitX();
    const double index = prism.refractive_index;
    beam = refract_at_face(beam, prism.is_inclined_at_entry ? inclined : square, 1.0 / index);
    beam = refract_at_face(beam, prism.is_inclined_at_entry ? square : inclined, index);
  }
  return beam.normalized();
}

ScanPattern::ScanPattern(const LidarConfig& config) : config_(config) {
  for (const Channel& channel : config.channels) {
    const double encoder = turn * config.rotation_rate * channel.delay;
    const double azimuth = channel.azimuth + encoder;
    const double cosine = std::cos(channel.elevation);
    channels_.push_back({static_cast<float>(cosine),
                         static_cast<float>(std::sin(channel.elevation)),
                         static_cast<float>(std::cos(azimuth)),
                         static_cast<float>(std::sin(azimuth)),
                         static_cast<float>(std::cos(encoder)),
                         static_cast<float>(std::sin(encoder)),
                         static_cast<float>(channel.height),
                         static_cast<float>(turned(1.0, azimuth / turn)),
                         channel.delay,
                         {cosine * std::cos(channel.azimuth), cosine * std::sin(channel.azimuth),
                          std::sin(channel.elevation)}});
  }
  std::vector<std::size_t>& by_elevation = rank_channels_;
  by_elevation.resize(config.channels.size());
  std::iota(by_elevation.begin(), by_elevation.end(), 0U);
  std::stable_sort(by_elevation.begin(), by_elevation.end(), [&](std::size_t a, std::size_t b) {
    return config.channels[a].elevation < config.channels[b].elevation;
  });
  rank_.resize(by_elevation.size());
  for (std::size_t i = 0; i < by_elevation.size(); ++i) rank_[by_elevation[i]] = i;
}

void ScanPattern::aim(std::uint64_t block, Pulses& pulses) const {
  for (int axis = 0; axis < 3; ++axis) {
    pulses.origin[axis].resize(slots());
    pulses.direction[axis].resize(slots());
  }
  pulses.azimuth.resize(slots());
  pulses.is_emitted.resize(slots());
  if (config_.prisms.empty()) {
    for (std::uint32_t firing = 0; firing < firings_in_block; firing += 4) {
      aim_spinning(block * firings_in_block + firing, pulses, slot(firing, rank_channels_[0]));
    }
    return;
  }
  for (std::uint32_t firing = 0; firing < firings_in_block; ++firing) {
    const double time =
        static_cast<double>(block * firings_in_block + firing) * config_.firing_period;
    aim_rosette(time, firing, pulses);
  }
}

// Computes four firings together, whose slots of a channel are adjacent.
void ScanPattern::aim_spinning(std::uint64_t first_firing, Pulses& pulses, std::size_t at) const {
  FourFloats angle, cosine, sine;
  for (int i = 0; i < 4; ++i) {
    const double time = static_cast<double>(first_firing + i) * config_.firing_period;
    const double exact = turned(config_.rotation_rate, time);
    angle[i] = static_cast<float>(exact);
    cosine[i] = static_cast<float>(std::cos(exact));
    sine[i] = static_cast<float>(std::sin(exact));
  }
  constexpr auto full = static_cast<float>(turn), half = static_cast<float>(0.5 * turn);
  const FourFloats none = {}, whole = none + full;
  const auto radius = static_cast<float>(config_.radial_offset);
  const float half_view =
      config_.field_of_view >= turn ? full : static_cast<float>(0.5 * config_.field_of_view);
  // As local variables, the array pointers remain in registers.
  float* const direction[3] = {pulses.direction[0].data(), pulses.direction[1].data(),
                               pulses.direction[2].data()};
  float* const origin[3] = {pulses.origin[0].data(), pulses.origin[1].data(),
                            pulses.origin[2].data()};
  float* const azimuths = pulses.azimuth.data();
  const std::size_t first = at;
  for (const std::size_t channel : rank_channels_) {
    const ChannelTable& table = channels_[channel];
    put_four(direction[0] + at,
             table.cos_elevation * (cosine * table.cos_azimuth - sine * table.sin_azimuth));
    put_four(direction[1] + at,
             table.cos_elevation * (sine * table.cos_azimuth + cosine * table.sin_azimuth));
    put_four(direction[2] + at, none + table.sin_elevation);
    put_four(origin[0] + at, radius * (cosine * table.cos_encoder - sine * table.sin_encoder));
    put_four(origin[1] + at, radius * (sine * table.cos_encoder + cosine * table.sin_encoder));
    put_four(origin[2] + at, none + table.height);
    FourFloats azimuth = angle + table.azimuth;  // In [0, 4 pi).
    azimuth -= azimuth > full ? whole : none;
    azimuth -= azimuth > half ? whole : none;
    put_four(azimuths + at, azimuth);
    at += 4;
  }
  std::uint8_t* const is_emitted = pulses.is_emitted.data();
  for (std::size_t i = first; i < at; ++i)
    is_emitted[i] = std::abs(azimuths[i]) <= half_view ? 1 : 0;
}

void ScanPattern::aim_rosette(double time, std::uint32_t firing, Pulses& pulses) const {
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    const ChannelTable& table = channels_[channel];
    const Vector3d direction = refract(config_.prisms, time + table.delay, table.beam);
    const std::size_t at = slot(firing, channel);
    for (int axis = 0; axis < 3; ++axis) {
      pulses.direction[axis][at] = static_cast<float>(direction[axis]);
      pulses.origin[axis][at] = axis == 2 ? table.height : 0.0F;
    }
    const double azimuth = std::atan2(direction.y(), direction.x());
    pulses.azimuth[at] = static_cast<float>(azimuth);
    pulses.is_emitted[at] = std::abs(azimuth) <= 0.5 * config_.field_of_view;
  }
}

}  // namespace skycap::sim
