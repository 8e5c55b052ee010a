#include "sim/sensors/lidar.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/sensors/block_echoes.h"
#include "sim/sensors/echo.h"
#include "sim/sensors/lidar_rays.h"
#include "sim/sensors/noise.h"
#include "sim/sensors/scan_pattern.h"

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
        has_constant_sigma(!config.errors.table.is_on() && config.errors.sigma_per_metre == 0.0 &&
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
  // Unit rays of the beam, in its own frame.
  std::vector<float> beam_along, beam_across, beam_above;
  bool has_constant_sigma;
  std::vector<float> biases;        // Bias of each channel [m].
  std::vector<float> delay_shares;  // Delay of each channel, as a fraction of the firing period.
};

namespace {

/// Buffers of a block of firings. Each thread keeps its own, so that a short scan does not start
/// with memory allocation.
struct BlockBuffers {
  BlockPoses poses, estimated;
  Pulses pulses;
  Rays pulse_rays;     // True axes of the pulses.
  Rays reported_rays;  // Axes as estimated by sensor and platform. Only used if they differ.
  Rays beam_rays;      // Rays of beams with width.
  Hits hits;
  std::vector<float> azimuth_noise, elevation_noise;
  std::vector<std::vector<float>> range_noise;  // One entry per possible return of a pulse.
  BlockEchoes echoes;
};

BlockBuffers& thread_buffers() {
  static thread_local BlockBuffers buffers;
  return buffers;
}

// Measures consecutive blocks. Slots are processed in groups of four: the same channel in four
// consecutive firings.
class BlockMeasurement {
 public:
  BlockMeasurement(const Lidar::Impl& lidar, const Scene& scene, const LidarFlight& flight,
                   LidarReturns& returns)
      : lidar_(lidar),
        config_(lidar.config),
        scene_(scene),
        flight_(flight),
        returns_(returns),
        origin_(scene.trees().centre),
        has_separate_estimate_(
            &flight.ground_truth != &flight.estimated ||
            !flight.body_from_sensor.isApprox(flight.estimated_body_from_sensor, 0.0)) {}

  void measure(std::uint64_t block, std::uint32_t first, std::uint32_t end) {
    const double start = flight_.ground_truth.start() +
                         static_cast<double>(block * firings_in_block) * config_.firing_period;
    poses_ = block_poses(flight_.ground_truth, flight_.body_from_sensor, start,
                         config_.firing_period, origin_);
    if (has_separate_estimate_) {
      estimated_ = block_poses(flight_.estimated, flight_.estimated_body_from_sensor, start,
                               config_.firing_period, origin_);
    }
    lidar_.pattern.aim(block, pulses_);
    draw_noise(block);
    compute_rays(poses_, pulse_rays_);
    cast(first, end);
    if (lidar_.beam.size() == 1) {
      echoes_.find_ray_echoes(hits_, scene_, config_);
    } else {
      echoes_.find_beam_echoes(hits_, lidar_.beam, scene_, config_);
    }
    if (has_separate_estimate_) compute_rays(estimated_, reported_rays_);
    report(start);
  }

  /// Removes the remainder of an earlier use.
  void finish() { returns_.resize(next_); }

 private:
  // Computes the rays of all pulses in the world frame.
  void compute_rays(const BlockPoses& poses, Rays& rays) const {
    rays.resize(lidar_.pattern.slots());
    for (std::uint32_t firing = 0; firing < firings_in_block; firing += 4) {
      const FourPoses now(poses, firing), next(poses, firing + 1);
      FourPoses later = now;
      for (std::size_t channel = 0; channel < config_.channels.size(); ++channel) {
        const std::size_t slot = lidar_.pattern.slot(firing, channel);
        const float share = lidar_.delay_shares[channel];
        if (share != 0.0F) later = delayed(now, next, share);
        const FourPoses& at = share == 0.0F ? now : later;
        FourFloats vector[3], placed[3];
        for (int axis = 0; axis < 3; ++axis) {
          std::memcpy(&vector[axis], &pulses_.direction[axis][slot], sizeof vector[axis]);
        }
        at.rotate(vector, placed);
        for (int axis = 0; axis < 3; ++axis) {
          put_four(&rays.direction[axis][slot], placed[axis]);
          std::memcpy(&vector[axis], &pulses_.origin[axis][slot], sizeof vector[axis]);
        }
        at.rotate(vector, placed);
        at.shift(placed);
        for (int axis = 0; axis < 3; ++axis) put_four(&rays.origin[axis][slot], placed[axis]);
      }
    }
  }

  Vector3f up(const BlockPoses& poses, std::size_t firing) const {
    return {poses.entries[2][firing], poses.entries[5][firing], poses.entries[8][firing]};
  }

  void cast(std::uint32_t first, std::uint32_t end) {
    const std::size_t samples = lidar_.beam.size();
    hits_.resize(lidar_.pattern.slots() * samples);
    if (samples > 1) beam_rays_.resize(lidar_.pattern.slots() * samples);
    std::size_t slot = 0;
    for (std::uint32_t four = 0; four < firings_in_block; four += 4) {
      for (std::size_t channel = 0; channel < config_.channels.size(); ++channel) {
        for (std::uint32_t firing = four; firing < four + 4; ++firing, ++slot) {
          const bool is_cast = pulses_.is_emitted[slot] != 0 && firing >= first && firing < end;
          if (samples == 1) {
            hits_.active[slot] = is_cast ? -1 : 0;
            continue;
          }
          std::fill_n(hits_.active.data() + slot * samples, samples, is_cast ? -1 : 0);
          if (is_cast) spread_beam(firing, slot);
        }
      }
    }
    cast_rays(scene_.trees(), static_cast<float>(config_.max_range),
              samples > 1 ? beam_rays_ : pulse_rays_, hits_);
  }

  void spread_beam(std::size_t firing, std::size_t slot) {
    const Vector3f axis = pulse_rays_.towards(slot);
    const AcrossBeam sides = across(axis, up(poses_, firing));
    const std::size_t samples = lidar_.beam.size(), first = slot * samples;
    const float* const along = lidar_.beam_along.data();
    const float* const aside = lidar_.beam_across.data();
    const float* const above = lidar_.beam_above.data();
    for (int i = 0; i < 3; ++i) {
      float* const direction = beam_rays_.direction[i].data() + first;
      for (std::size_t ray = 0; ray < samples; ++ray) {
        direction[ray] = along[ray] * axis[i] + aside[ray] * sides.horizontal[i] +
                         above[ray] * sides.vertical[i];
      }
      std::fill_n(beam_rays_.origin[i].data() + first, samples, pulse_rays_.origin[i][slot]);
    }
  }

  // Draws one normal variate per slot, error and return, for active errors only.
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
    has_range_noise_ = errors.sigma > 0.0 || errors.sigma_per_metre > 0.0 ||
                       errors.sigma_per_square_metre > 0.0 || errors.table.is_on();
    echoes_.rows.resize(lidar_.beam.size() > 1 ? config_.beam.max_returns : 1);
    range_noise_.resize(echoes_.rows.size());
    if (!has_range_noise_) return;
    for (std::uint32_t i = 0; i < range_noise_.size(); ++i) {
      draw(range_stream + i, range_noise_[i]);
    }
  }

  // Appends the echoes as returns, in the order of firings and channels.
  void report(double start) {
    for (std::uint32_t firing = 0; firing < firings_in_block; firing += 4) {
      const std::size_t fours = config_.channels.size(), first = firing * fours;
      FourInts counts = {};
      for (std::size_t slot_group = 0; slot_group < fours; ++slot_group) {
        counts += load<FourInts>(echoes_.counts, first + 4 * slot_group);
      }
      const std::size_t all = next_ + static_cast<std::size_t>(sum(counts));
      if (returns_.size() < all) returns_.resize(all);
      std::size_t offsets[4];
      for (int lane = 0; lane < 4; ++lane) {
        offsets[lane] = next_;
        next_ += static_cast<std::size_t>(counts[lane]);
      }
      const Destination to(returns_);
      for (std::size_t channel = 0; channel < fours; ++channel) {
        report_four(firing, channel, start, offsets, to);
      }
    }
  }

  /// Pointers to the arrays of returns. As local variables they remain in registers, because stored
  /// bytes could otherwise alias them.
  struct Destination {
    explicit Destination(LidarReturns& returns)
        : points(returns.points.data()),
          true_points(returns.true_points.data()),
          times(returns.times.data()),
          intensities(returns.intensities.data()),
          scan_angles(returns.scan_angles.data()),
          triangles(returns.triangles.data()),
          channels(returns.channels.data()),
          return_numbers(returns.return_numbers.data()),
          number_of_returns(returns.number_of_returns.data()) {}

    Vector3f *points, *true_points;
    double* times;
    float *intensities, *scan_angles;
    std::uint32_t* triangles;
    std::uint16_t* channels;
    std::uint8_t *return_numbers, *number_of_returns;
  };

  void report_four(std::uint32_t firing, std::size_t channel, double start,
                   std::size_t (&offsets)[4], const Destination to) const {
    const std::size_t slot = lidar_.pattern.slot(firing, channel);
    const FourInts counts = load<FourInts>(echoes_.counts, slot);
    const Rays& rays = has_separate_estimate_ ? reported_rays_ : pulse_rays_;
    const bool is_misled = config_.errors.angle_sigma > 0.0;
    double times[4];
    for (int lane = 0; lane < 4; ++lane) {
      times[lane] =
          start + (firing + lane) * config_.firing_period + config_.channels[channel].delay;
    }
    for (std::size_t number = 0; number < echoes_.rows.size(); ++number) {
      const FourInts is_there = counts > static_cast<int>(number);
      if (sum(is_there) == 0) break;
      const EchoRow& row = echoes_.rows[number];
      const FourFloats range = load<FourFloats>(row.range, slot);
      const FourFloats measured = measured_range(number, channel, slot, range);
      FourFloats point[3], true_point[3];
      for (int axis = 0; axis < 3; ++axis) {
        true_point[axis] = load<FourFloats>(pulse_rays_.origin[axis], slot) +
                           range * load<FourFloats>(pulse_rays_.direction[axis], slot);
        point[axis] = load<FourFloats>(rays.origin[axis], slot) +
                      measured * load<FourFloats>(rays.direction[axis], slot);
      }
      for (int lane = 0; lane < 4; ++lane) {
        if (is_there[lane] == 0) continue;
        const std::size_t i = offsets[lane] + number, at = slot + static_cast<std::size_t>(lane);
        to.points[i] =
            is_misled ? misled(rays, at, firing + static_cast<std::size_t>(lane), measured[lane])
                      : Vector3f(point[0][lane], point[1][lane], point[2][lane]);
        to.true_points[i] = {true_point[0][lane], true_point[1][lane], true_point[2][lane]};
        to.times[i] = times[lane];
        to.intensities[i] = row.intensity[at];
        to.scan_angles[i] = pulses_.azimuth[at];
        to.triangles[i] = row.triangle[at];
        to.channels[i] = static_cast<std::uint16_t>(channel);
        to.return_numbers[i] = static_cast<std::uint8_t>(number + 1);
        to.number_of_returns[i] = static_cast<std::uint8_t>(counts[lane]);
      }
    }
    for (int lane = 0; lane < 4; ++lane) offsets[lane] += static_cast<std::size_t>(counts[lane]);
  }

  FourFloats measured_range(std::size_t number, std::size_t channel, std::size_t slot,
                            FourFloats range) const {
    const RangeErrors& errors = config_.errors;
    FourFloats measured = range + lidar_.biases[channel];
    if (has_range_noise_) {
      FourFloats sigma = FourFloats{} + static_cast<float>(errors.sigma);
      for (int lane = 0; lane < 4 && !lidar_.has_constant_sigma; ++lane) {
        // Slots without an echo have no triangle.
        if (echoes_.counts[slot + lane] <= static_cast<int>(number)) continue;
        const EchoRow& row = echoes_.rows[number];
        sigma[lane] = range_sigma(errors, range[lane], row.cosine[slot + lane],
                                  scene_.reflectance(row.triangle[slot + lane]));
      }
      measured += sigma * load<FourFloats>(range_noise_[number], slot);
    }
    if (errors.range_step <= 0.0) return measured;
    for (int lane = 0; lane < 4; ++lane) {
      const double steps = std::nearbyint(measured[lane] / errors.range_step);
      measured[lane] = static_cast<float>(steps * errors.range_step);
    }
    return measured;
  }

  // Returns a point along a ray rotated by the angle errors of the sensor.
  Vector3f misled(const Rays& rays, std::size_t slot, std::size_t firing, float range) const {
    const auto sigma = static_cast<float>(config_.errors.angle_sigma);
    const Vector3f direction = rays.towards(slot);
    const AcrossBeam sides =
        across(direction, up(has_separate_estimate_ ? estimated_ : poses_, firing));
    const Vector3f turned = direction + sigma * azimuth_noise_[slot] * sides.horizontal +
                            sigma * elevation_noise_[slot] * sides.vertical;
    return rays.from(slot) + range * turned.normalized();
  }

  template <typename Four, typename Lane>
  static Four load(const std::vector<Lane>& values, std::size_t slot) {
    Four lanes;
    std::memcpy(&lanes, values.data() + slot, sizeof lanes);
    return lanes;
  }

  const Lidar::Impl& lidar_;
  const LidarConfig& config_;
  const Scene& scene_;
  const LidarFlight& flight_;
  LidarReturns& returns_;
  Vector3d origin_;
  bool has_separate_estimate_;
  bool has_range_noise_ = false;

  BlockBuffers& buffers_ = thread_buffers();
  BlockPoses &poses_ = buffers_.poses, &estimated_ = buffers_.estimated;
  Pulses& pulses_ = buffers_.pulses;
  Rays &pulse_rays_ = buffers_.pulse_rays, &reported_rays_ = buffers_.reported_rays;
  Rays& beam_rays_ = buffers_.beam_rays;
  Hits& hits_ = buffers_.hits;
  std::vector<float>&azimuth_noise_ = buffers_.azimuth_noise,
  &elevation_noise_ = buffers_.elevation_noise;
  std::vector<std::vector<float>>& range_noise_ = buffers_.range_noise;
  BlockEchoes& echoes_ = buffers_.echoes;
  std::size_t next_ = 0;  // Index of the next return.
};

}  // namespace

Lidar::Lidar(const LidarConfig& config) : impl_(std::make_unique<const Impl>(config)) {}
Lidar::~Lidar() = default;
Lidar::Lidar(Lidar&&) noexcept = default;
Lidar& Lidar::operator=(Lidar&&) noexcept = default;

const LidarConfig& Lidar::config() const { return impl_->config; }

std::uint64_t Lidar::firings(const Trajectory& trajectory) const {
  constexpr double rounding = 1e-9;  // A duration of whole periods must contain all of them.
  const double duration = trajectory.end() - trajectory.start();
  return static_cast<std::uint64_t>(duration / impl_->config.firing_period + rounding);
}

LidarReturns Lidar::measure(const Scene& scene, const LidarFlight& flight, FiringRange firings,
                            LidarReturns buffer) const {
  LidarReturns returns = std::move(buffer);  // Every remaining entry is overwritten.
  returns.origin = scene.trees().centre;
  BlockMeasurement measurement(*impl_, scene, flight, returns);
  const std::uint64_t end = firings.first + firings.count;
  for (std::uint64_t first = firings.first; first < end;) {
    const std::uint64_t block = first / firings_in_block;
    const std::uint64_t block_start = block * firings_in_block;
    const std::uint64_t block_end = std::min(block_start + firings_in_block, end);
    measurement.measure(block, static_cast<std::uint32_t>(first - block_start),
                        static_cast<std::uint32_t>(block_end - block_start));
    first = block_end;
  }
  measurement.finish();
  return returns;
}

}  // namespace skycap::sim
