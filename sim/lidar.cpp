#include "sim/lidar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "sim/echo.h"
#include "sim/noise.h"
#include "sim/scan_pattern.h"
#include "sim/scene_embree.h"

namespace skycap::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::uint32_t firings_in_block = ScanPattern::firings_in_block;
constexpr double pose_spacing = 1e-4;  // [s]; how often a trajectory is asked
enum Stream : std::uint32_t { bias_stream, azimuth_stream, elevation_stream, range_stream };

// world_from_sensor relative to a fixed origin, in the precision of the rays.
struct Pose {
  Eigen::Matrix3f rotation;
  Vector3f position;

  Pose between(const Pose& next, float share) const {
    return {rotation + share * (next.rotation - rotation),
            position + share * (next.position - position)};
  }
};

// The poses at the start of each firing of a block, and at the start of the next block.
using BlockPoses = std::array<Pose, firings_in_block + 1>;

Pose pose_at(const Trajectory& trajectory, const Isometry3d& body_from_sensor, double time,
             const Vector3d& origin) {
  const Isometry3d pose = trajectory.pose(time) * body_from_sensor;
  return {pose.linear().cast<float>(), (pose.translation() - origin).cast<float>()};
}

BlockPoses block_poses(const Trajectory& trajectory, const Isometry3d& body_from_sensor,
                       double start, double firing_period, const Vector3d& origin) {
  const double duration = firing_period * firings_in_block;
  const int spans = std::clamp(static_cast<int>(std::ceil(duration / pose_spacing)), 1,
                               static_cast<int>(firings_in_block));
  std::array<Pose, firings_in_block + 1> knots;
  for (int i = 0; i <= spans; ++i) {
    knots[i] = pose_at(trajectory, body_from_sensor, start + duration * i / spans, origin);
  }
  BlockPoses poses;
  for (int firing = 0; firing <= static_cast<int>(firings_in_block); ++firing) {
    const int knot = std::min(firing * spans / static_cast<int>(firings_in_block), spans - 1);
    const float share = static_cast<float>(firing * spans) / static_cast<float>(firings_in_block) -
                        static_cast<float>(knot);
    poses[firing] = knots[knot].between(knots[knot + 1], share);
  }
  return poses;
}

// Directions across a beam, sensor frame: along azimuth and along elevation.
struct AcrossBeam {
  Vector3f horizontal, vertical;
};
AcrossBeam across(const Vector3f& direction) {
  const float length = std::hypot(direction.x(), direction.y());
  const Vector3f horizontal = length > 1e-6F
                                  ? Vector3f(-direction.y() / length, direction.x() / length, 0.0F)
                                  : Vector3f::UnitY();
  return {horizontal, direction.cross(horizontal)};
}

// Rays in the frame of Embree's scene, in the order of the packets, and what they meet.
struct Rays {
  std::vector<float> origin[3], direction[3];
  std::vector<int> active;    // -1 or 0, as Embree wants it
  std::vector<float> range;   // negative: nothing
  std::vector<float> cosine;  // of the angle of incidence
  std::vector<std::uint32_t> triangle;

  void resize(std::size_t rays) {
    const std::size_t padded = (rays + 15) / 16 * 16;  // whole packets of any width
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis].resize(padded);
      direction[axis].resize(padded);
    }
    active.assign(padded, 0);
    range.resize(padded);
    cosine.resize(padded);
    triangle.resize(padded);
  }
  void set(std::size_t ray, const Vector3f& from, const Vector3f& towards) {
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis][ray] = from[axis];
      direction[axis][ray] = towards[axis];
    }
    active[ray] = -1;
  }
};

template <int width>
void cast_rays(const Scene::Embree& embree, float reach, Rays& rays) {
  Packet<width> packet;
  const auto load = [](float* lanes, const std::vector<float>& values, std::size_t first) {
    std::memcpy(lanes, values.data() + first, width * sizeof(float));
  };
  for (std::size_t first = 0; first < rays.active.size(); first += width) {
    std::memcpy(packet.active, rays.active.data() + first, width * sizeof(int));
    if (std::all_of(packet.active, packet.active + width, [](int lane) { return lane == 0; })) {
      continue;
    }
    auto& ray = packet.rays.ray;
    auto& hit = packet.rays.hit;
    load(ray.org_x, rays.origin[0], first);
    load(ray.org_y, rays.origin[1], first);
    load(ray.org_z, rays.origin[2], first);
    load(ray.dir_x, rays.direction[0], first);
    load(ray.dir_y, rays.direction[1], first);
    load(ray.dir_z, rays.direction[2], first);
    packet.cast(embree, reach);
    for (int lane = 0; lane < width; ++lane) {
      const float projection = ray.dir_x[lane] * hit.Ng_x[lane] + ray.dir_y[lane] * hit.Ng_y[lane] +
                               ray.dir_z[lane] * hit.Ng_z[lane];
      const float square = hit.Ng_x[lane] * hit.Ng_x[lane] + hit.Ng_y[lane] * hit.Ng_y[lane] +
                           hit.Ng_z[lane] * hit.Ng_z[lane];
      rays.range[first + lane] = packet.is_hit(lane) ? ray.tfar[lane] : -1.0F;
      rays.cosine[first + lane] = std::min(1.0F, std::abs(projection) / std::sqrt(square));
      rays.triangle[first + lane] = hit.primID[lane];
    }
  }
}

}  // namespace

struct Lidar::Impl {
  explicit Impl(const LidarConfig& given)
      : config((given.validate(), given)), pattern(config), beam(beam_samples(config.beam.rings)) {
    std::vector<float> normals(config.channels.size());
    fill_normals(noise_key(config.seed, bias_stream, 0), 0, normals);
    for (const float normal : normals) {
      biases.push_back(static_cast<float>(config.errors.channel_bias_sigma) * normal);
    }
  }

  LidarConfig config;
  ScanPattern pattern;
  std::vector<BeamSample> beam;
  std::vector<float> biases;  // of each channel
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
    cast(first, end);
    draw_noise(block);
    for (std::uint32_t firing = first; firing < end; ++firing) {
      for (std::size_t channel = 0; channel < config_.channels.size(); ++channel) {
        const std::size_t slot = lidar_.pattern.slot(firing, channel);
        if (shots_.is_shot[slot] == 0) continue;
        const double time =
            start + firing * config_.firing_period + config_.channels[channel].delay;
        report(firing, channel, slot, time, returns);
      }
    }
  }

 private:
  Vector3f direction(std::size_t slot) const {
    return {shots_.direction[0][slot], shots_.direction[1][slot], shots_.direction[2][slot]};
  }
  Vector3f laser(std::size_t slot) const {
    return {shots_.origin[0][slot], shots_.origin[1][slot], shots_.origin[2][slot]};
  }
  Pose pose(const BlockPoses& poses, std::uint32_t firing, std::size_t channel) const {
    const double share = config_.channels[channel].delay / config_.firing_period;
    return share == 0.0 ? poses[firing]
                        : poses[firing].between(poses[firing + 1], static_cast<float>(share));
  }

  void cast(std::uint32_t first, std::uint32_t end) {
    const std::size_t samples = lidar_.beam.size();
    rays_.resize(lidar_.pattern.slots() * samples);
    const auto half_width = static_cast<float>(0.5 * config_.beam.divergence_horizontal);
    const auto half_height = static_cast<float>(0.5 * config_.beam.divergence_vertical);
    for (std::uint32_t firing = first; firing < end; ++firing) {
      for (std::size_t channel = 0; channel < config_.channels.size(); ++channel) {
        const std::size_t slot = lidar_.pattern.slot(firing, channel);
        if (shots_.is_shot[slot] == 0) continue;
        const Pose at = pose(poses_, firing, channel);
        const Vector3f from = at.position + at.rotation * laser(slot);
        const Vector3f axis = direction(slot);
        rays_.set(slot * samples, from, at.rotation * axis);
        if (samples == 1) continue;
        const AcrossBeam sides = across(axis);
        const Vector3f right = at.rotation * (half_width * sides.horizontal);
        const Vector3f up = at.rotation * (half_height * sides.vertical);
        for (std::size_t i = 1; i < samples; ++i) {
          const BeamSample& sample = lidar_.beam[i];
          const Vector3f towards =
              at.rotation * axis + sample.horizontal * right + sample.vertical * up;
          rays_.set(slot * samples + i, from, towards.normalized());
        }
      }
    }
    with_packet_width(scene_.embree(), [&]<int width>() {
      cast_rays<width>(scene_.embree(), static_cast<float>(config_.max_range), rays_);
    });
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
    if (!has_range_noise_) return;
    range_noise_.resize(config_.beam.rings > 0 ? config_.beam.max_returns : 1);
    for (std::uint32_t i = 0; i < range_noise_.size(); ++i) {
      draw(range_stream + i, range_noise_[i]);
    }
  }

  std::optional<RayHit> hit(std::size_t ray, float share) const {
    if (rays_.range[ray] < static_cast<float>(config_.min_range)) return std::nullopt;
    return RayHit{rays_.range[ray], rays_.cosine[ray], scene_.reflectance(rays_.triangle[ray]),
                  share, rays_.triangle[ray]};
  }

  void report(std::uint32_t firing, std::size_t channel, std::size_t slot, double time,
              LidarReturns& returns) {
    const std::size_t samples = lidar_.beam.size();
    if (samples == 1) {
      const auto only = hit(slot, 1.0F);
      if (!only) return;
      const float power = received_power(*only, config_.sensitivity);
      if (power < 1.0F) return;
      const Echo echo = {only->range, only->cosine, only->reflectance * only->cosine, power,
                         only->triangle};
      report(echo, 0, 1, firing, channel, slot, time, returns);
      return;
    }
    hits_.clear();
    for (std::size_t i = 0; i < samples; ++i) {
      if (const auto one = hit(slot * samples + i, lidar_.beam[i].share)) hits_.push_back(*one);
    }
    const std::vector<Echo> echoes = form_echoes(hits_, config_.sensitivity, config_.beam);
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      report(echoes[i], i, echoes.size(), firing, channel, slot, time, returns);
    }
  }

  void report(const Echo& echo, std::size_t number, std::size_t count, std::uint32_t firing,
              std::size_t channel, std::size_t slot, double time, LidarReturns& returns) const {
    const RangeErrors& errors = config_.errors;
    float range = echo.range + lidar_.biases[channel];
    if (has_range_noise_) {
      range += range_sigma(errors, echo.range, echo.cosine) * range_noise_[number][slot];
    }
    if (errors.range_step > 0.0) {
      range = static_cast<float>(std::round(range / errors.range_step) * errors.range_step);
    }
    Vector3f reported = direction(slot);
    if (errors.angle_sigma > 0.0) {
      const auto sigma = static_cast<float>(errors.angle_sigma);
      const AcrossBeam sides = across(reported);
      reported = (reported + sigma * azimuth_noise_[slot] * sides.horizontal +
                  sigma * elevation_noise_[slot] * sides.vertical)
                     .normalized();
    }
    const Pose true_pose = pose(poses_, firing, channel);
    const Pose believed_pose = has_own_belief_ ? pose(believed_, firing, channel) : true_pose;
    returns.points.emplace_back(believed_pose.position +
                                believed_pose.rotation * (laser(slot) + range * reported));
    returns.true_points.emplace_back(
        true_pose.position + true_pose.rotation * (laser(slot) + echo.range * direction(slot)));
    returns.times.push_back(time);
    returns.intensities.push_back(echo.intensity);
    returns.scan_angles.push_back(shots_.azimuth[slot]);
    returns.triangles.push_back(echo.triangle);
    returns.channels.push_back(static_cast<std::uint16_t>(channel));
    returns.return_numbers.push_back(static_cast<std::uint8_t>(number + 1));
    returns.returns_of_shots.push_back(static_cast<std::uint8_t>(count));
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
  Rays rays_;
  std::vector<float> azimuth_noise_, elevation_noise_;
  std::vector<std::vector<float>> range_noise_;  // for each return of a shot
  std::vector<RayHit> hits_;
};

}  // namespace

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

LidarReturns Lidar::measure(const Scene& scene, const LidarFlight& flight,
                            FiringRange firings) const {
  LidarReturns returns;
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
