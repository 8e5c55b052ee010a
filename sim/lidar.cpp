#include "sim/lidar.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/echo.h"
#include "sim/lidar_rays.h"
#include "sim/noise.h"
#include "sim/scan_pattern.h"

namespace skycap::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

enum Stream : std::uint32_t { bias_stream, azimuth_stream, elevation_stream, range_stream };

}  // namespace

struct Lidar::Impl {
  explicit Impl(const LidarConfig& given)
      : config((given.validate(), given)),
        pattern(config),
        beam(beam_samples(config.beam.rings)),
        min_range(static_cast<float>(config.min_range)),
        has_constant_sigma(config.errors.sigma_per_metre == 0.0 &&
                           config.errors.sigma_per_square_metre == 0.0 &&
                           config.errors.incidence_power == 0.0) {
    for (const BeamSample& sample : beam) {
      const double across = 0.5 * config.beam.divergence_horizontal * sample.horizontal;
      const double above = 0.5 * config.beam.divergence_vertical * sample.vertical;
      const double length = std::sqrt(1.0 + across * across + above * above);
      beam_along.push_back(static_cast<float>(1.0 / length));
      beam_across.push_back(static_cast<float>(across / length));
      beam_above.push_back(static_cast<float>(above / length));
    }
    for (const Channel& channel : config.channels) {
      delay_shares.push_back(static_cast<float>(channel.delay / config.firing_period));
    }
    std::vector<float> normals(config.channels.size());
    fill_normals(noise_key(config.seed, bias_stream, 0), 0, normals);
    for (const float normal : normals) {
      biases.push_back(static_cast<float>(config.errors.channel_bias_sigma) * normal);
    }
  }

  LidarConfig config;
  ScanPattern pattern;
  std::vector<BeamSample> beam;
  std::vector<float> beam_along, beam_across, beam_above;  // its unit rays, in the beam's frame
  float min_range;
  bool has_constant_sigma;
  std::vector<float> biases;        // of each channel
  std::vector<float> delay_shares;  // of each channel's delay in the firing period
};

namespace {

// Everything that measuring one block after another needs; its buffers are used again.
class BlockMeasurement {
 public:
  BlockMeasurement(const Lidar::Impl& lidar, const Scene& scene, const LidarFlight& flight)
      : lidar_(lidar),
        config_(lidar.config),
        scene_(scene),
        flight_(flight),
        origin_(scene.embree().centre),
        has_own_belief_(&flight.flown != &flight.believed ||
                        !flight.body_from_sensor.isApprox(flight.believed_body_from_sensor, 0.0)) {}

  void measure(std::uint64_t block, std::uint32_t first, std::uint32_t end, LidarReturns& returns) {
    const double start = flight_.flown.start() +
                         static_cast<double>(block * firings_in_block) * config_.firing_period;
    poses_ =
        block_poses(flight_.flown, flight_.body_from_sensor, start, config_.firing_period, origin_);
    if (has_own_belief_) {
      believed_ = block_poses(flight_.believed, flight_.believed_body_from_sensor, start,
                              config_.firing_period, origin_);
    }
    lidar_.pattern.aim(block, shots_);
    draw_noise(block);
    place(poses_, shots_rays_);
    cast(first, end);
    if (has_own_belief_) place(believed_, reported_rays_);

    const std::size_t shots = (end - first) * config_.channels.size();
    const std::size_t before = returns.size();
    resize(returns, before + shots * range_noise_.size());
    next_ = before;
    for (std::uint32_t firing = first; firing < end; ++firing) {
      const double time = start + firing * config_.firing_period;
      if (lidar_.beam.size() == 1) {
        report_rays(firing, time, returns);
      } else {
        report_beams(firing, time, returns);
      }
    }
    resize(returns, next_);
  }

 private:
  // The rays of all shots in the world, four firings of a channel at a time.
  void place(const BlockPoses& poses, Rays& rays) const {
    rays.resize(lidar_.pattern.slots());
    for (std::uint32_t firing = 0; firing < firings_in_block; firing += 4) {
      const FourPoses now(poses, firing), next(poses, firing + 1);
      for (std::size_t channel = 0; channel < config_.channels.size(); ++channel) {
        const std::size_t slot = lidar_.pattern.slot(firing, channel);
        const float share = lidar_.delay_shares[channel];
        const FourPoses at = share == 0.0F ? now : delayed(now, next, share);
        FourFloats vector[3], placed[3];
        for (int axis = 0; axis < 3; ++axis) {
          std::memcpy(&vector[axis], &shots_.direction[axis][slot], sizeof vector[axis]);
        }
        at.rotate(vector, placed);
        for (int axis = 0; axis < 3; ++axis) {
          std::memcpy(&rays.direction[axis][slot], &placed[axis], sizeof placed[axis]);
          std::memcpy(&vector[axis], &shots_.origin[axis][slot], sizeof vector[axis]);
        }
        at.rotate(vector, placed);
        at.shift(placed);
        for (int axis = 0; axis < 3; ++axis) {
          std::memcpy(&rays.origin[axis][slot], &placed[axis], sizeof placed[axis]);
        }
      }
    }
  }

  Vector3f up(const BlockPoses& poses, std::uint32_t firing) const {
    return {poses.entries[2][firing], poses.entries[5][firing], poses.entries[8][firing]};
  }

  void cast(std::uint32_t first, std::uint32_t end) {
    const std::size_t samples = lidar_.beam.size();
    hits_.resize(lidar_.pattern.slots() * samples);
    if (samples > 1) beam_rays_.resize(lidar_.pattern.slots() * samples);
    for (std::uint32_t firing = first; firing < end; ++firing) {
      for (std::size_t channel = 0; channel < config_.channels.size(); ++channel) {
        const std::size_t slot = lidar_.pattern.slot(firing, channel);
        if (shots_.is_shot[slot] == 0) continue;
        std::fill_n(hits_.active.begin() + static_cast<std::ptrdiff_t>(slot * samples), samples,
                    -1);
        if (samples > 1) spread_beam(firing, slot);
      }
    }
    with_packet_width(scene_.embree(), [&]<int width>() {
      cast_rays<width>(scene_.embree(), static_cast<float>(config_.max_range),
                       samples > 1 ? beam_rays_ : shots_rays_, hits_);
    });
  }

  void spread_beam(std::uint32_t firing, std::size_t slot) {
    const Vector3f axis = shots_rays_.towards(slot);
    const AcrossBeam sides = across(axis, up(poses_, firing));
    const std::size_t samples = lidar_.beam.size(), first = slot * samples;
    for (int i = 0; i < 3; ++i) {
      float* const direction = beam_rays_.direction[i].data() + first;
      for (std::size_t ray = 0; ray < samples; ++ray) {
        direction[ray] = lidar_.beam_along[ray] * axis[i] +
                         lidar_.beam_across[ray] * sides.horizontal[i] +
                         lidar_.beam_above[ray] * sides.vertical[i];
      }
      std::fill_n(beam_rays_.origin[i].data() + first, samples, shots_rays_.origin[i][slot]);
    }
  }

  static void resize(LidarReturns& returns, std::size_t size) {
    returns.points.resize(size);
    returns.true_points.resize(size);
    returns.times.resize(size);
    returns.intensities.resize(size);
    returns.scan_angles.resize(size);
    returns.triangles.resize(size);
    returns.channels.resize(size);
    returns.return_numbers.resize(size);
    returns.returns_of_shots.resize(size);
  }

  // One normal for each slot, error and return; only for the errors that are on.
  void draw_noise(std::uint64_t block) {
    const auto draw = [&](std::uint32_t stream, std::vector<float>& normals) {
      normals.resize(lidar_.pattern.slots());
      fill_normals(noise_key(config_.seed, stream, block), 0, normals);
    };
    const RangeErrors& errors = config_.errors;
    if (errors.angle_sigma > 0.0) {
      draw(azimuth_stream, azimuth_noise_);
      draw(elevation_stream, elevation_noise_);
    }
    has_range_noise_ =
        errors.sigma > 0.0 || errors.sigma_per_metre > 0.0 || errors.sigma_per_square_metre > 0.0;
    range_noise_.resize(config_.beam.rings > 0 ? config_.beam.max_returns : 1);
    if (!has_range_noise_) return;
    for (std::uint32_t i = 0; i < range_noise_.size(); ++i) {
      draw(range_stream + i, range_noise_[i]);
    }
  }

  RayHit hit(std::size_t ray, float share) const {
    return {hits_.range[ray], std::min(1.0F, hits_.cosine[ray]),
            scene_.reflectance(hits_.triangle[ray]), share, hits_.triangle[ray]};
  }

  // A firing of beams without a width: a ray is its echo.
  void report_rays(std::uint32_t firing, double time, LidarReturns& returns) {
    for (std::size_t channel = 0; channel < config_.channels.size(); ++channel) {
      const std::size_t slot = lidar_.pattern.slot(firing, channel);
      if (hits_.range[slot] < lidar_.min_range) continue;
      const RayHit only = hit(slot, 1.0F);
      const float power = received_power(only, config_.sensitivity);
      if (power < 1.0F) continue;
      const Echo echo = {only.range, only.cosine, only.reflectance * only.cosine, power,
                         only.triangle};
      report(echo, 0, 1, {firing, channel, slot, time}, returns);
    }
  }

  void report_beams(std::uint32_t firing, double time, LidarReturns& returns) {
    const std::size_t samples = lidar_.beam.size();
    for (std::size_t channel = 0; channel < config_.channels.size(); ++channel) {
      const std::size_t slot = lidar_.pattern.slot(firing, channel);
      beam_hits_.clear();
      for (std::size_t i = 0; i < samples; ++i) {
        const std::size_t ray = slot * samples + i;
        if (hits_.range[ray] < lidar_.min_range) continue;
        beam_hits_.push_back(hit(ray, lidar_.beam[i].share));
      }
      echoes_ = form_echoes(beam_hits_, config_.sensitivity, config_.beam, std::move(echoes_));
      for (std::size_t i = 0; i < echoes_.size(); ++i) {
        report(echoes_[i], i, echoes_.size(), {firing, channel, slot, time}, returns);
      }
    }
  }

  struct Shot {
    std::uint32_t firing;
    std::size_t channel, slot;
    double firing_time;
  };

  void report(const Echo& echo, std::size_t number, std::size_t count, const Shot& shot,
              LidarReturns& returns) {
    const RangeErrors& errors = config_.errors;
    const std::size_t slot = shot.slot;
    float range = echo.range + lidar_.biases[shot.channel];
    if (has_range_noise_) {
      const float sigma = lidar_.has_constant_sigma ? static_cast<float>(errors.sigma)
                                                    : range_sigma(errors, echo.range, echo.cosine);
      range += sigma * range_noise_[number][slot];
    }
    if (errors.range_step > 0.0) {
      range = static_cast<float>(std::round(range / errors.range_step) * errors.range_step);
    }
    const Rays& rays = has_own_belief_ ? reported_rays_ : shots_rays_;
    const std::size_t i = next_++;
    returns.points[i] = errors.angle_sigma > 0.0 ? misled(rays, shot, range) : rays.at(slot, range);
    returns.true_points[i] = shots_rays_.at(slot, echo.range);
    returns.times[i] = shot.firing_time + config_.channels[shot.channel].delay;
    returns.intensities[i] = echo.intensity;
    returns.scan_angles[i] = shots_.azimuth[slot];
    returns.triangles[i] = echo.triangle;
    returns.channels[i] = static_cast<std::uint16_t>(shot.channel);
    returns.return_numbers[i] = static_cast<std::uint8_t>(number + 1);
    returns.returns_of_shots[i] = static_cast<std::uint8_t>(count);
  }

  // A point along a ray that is turned by the errors of the sensor's angles.
  Vector3f misled(const Rays& rays, const Shot& shot, float range) const {
    const auto sigma = static_cast<float>(config_.errors.angle_sigma);
    const Vector3f direction = rays.towards(shot.slot);
    const AcrossBeam sides =
        across(direction, up(has_own_belief_ ? believed_ : poses_, shot.firing));
    const Vector3f turned = direction + sigma * azimuth_noise_[shot.slot] * sides.horizontal +
                            sigma * elevation_noise_[shot.slot] * sides.vertical;
    return rays.from(shot.slot) + range * turned.normalized();
  }

  const Lidar::Impl& lidar_;
  const LidarConfig& config_;
  const Scene& scene_;
  const LidarFlight& flight_;
  Vector3d origin_;
  bool has_own_belief_;
  bool has_range_noise_ = false;

  BlockPoses poses_, believed_;
  Shots shots_;
  Rays shots_rays_;     // the axes of the shots as they were
  Rays reported_rays_;  // and as the sensor and its carrier believe; only if they differ
  Rays beam_rays_;      // of beams with a width
  Hits hits_;
  std::vector<float> azimuth_noise_, elevation_noise_;
  std::vector<std::vector<float>> range_noise_;  // for each return of a shot
  std::vector<RayHit> beam_hits_;
  std::vector<Echo> echoes_;
  std::size_t next_ = 0;  // where the next return goes
};

}  // namespace

void LidarReturns::clear() {
  points.clear();
  true_points.clear();
  times.clear();
  intensities.clear();
  scan_angles.clear();
  triangles.clear();
  channels.clear();
  return_numbers.clear();
  returns_of_shots.clear();
}

Lidar::Lidar(const LidarConfig& config) : impl_(std::make_unique<const Impl>(config)) {}
Lidar::~Lidar() = default;
Lidar::Lidar(Lidar&&) noexcept = default;
Lidar& Lidar::operator=(Lidar&&) noexcept = default;

const LidarConfig& Lidar::config() const { return impl_->config; }

std::uint64_t Lidar::firings(const Trajectory& trajectory) const {
  constexpr double rounding = 1e-9;  // a duration of whole periods has them all
  const double duration = trajectory.end() - trajectory.start();
  return static_cast<std::uint64_t>(duration / impl_->config.firing_period + rounding);
}

LidarReturns Lidar::measure(const Scene& scene, const LidarFlight& flight, FiringRange firings,
                            LidarReturns recycled) const {
  LidarReturns returns = std::move(recycled);
  returns.clear();
  returns.origin = scene.embree().centre;
  BlockMeasurement measurement(*impl_, scene, flight);
  const std::uint64_t end = firings.first + firings.count;
  for (std::uint64_t first = firings.first; first < end;) {
    const std::uint64_t block = first / firings_in_block;
    const std::uint64_t block_start = block * firings_in_block;
    const std::uint64_t block_end = std::min(block_start + firings_in_block, end);
    measurement.measure(block, static_cast<std::uint32_t>(first - block_start),
                        static_cast<std::uint32_t>(block_end - block_start), returns);
    first = block_end;
  }
  return returns;
}

}  // namespace skycap::sim
