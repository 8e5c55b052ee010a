#include "sim/lidar.h"

#include <algorithm>
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

// world_from_sensor at the start of each firing of a block and of the next, relative to a fixed
// origin: the nine entries of the rotation, row by row, and the position. Four firings lie
// together, as their rays do.
struct BlockPoses {
  float entries[12][firings_in_block + 4];
};

// The poses of four consecutive firings.
struct FourPoses {
  FourFloats entries[12];

  FourPoses(const BlockPoses& poses, std::uint32_t firing) {
    for (int i = 0; i < 12; ++i) {
      std::memcpy(&entries[i], &poses.entries[i][firing], sizeof entries[i]);
    }
  }
  void rotate(const FourFloats (&vector)[3], FourFloats (&rotated)[3]) const {
    for (int row = 0; row < 3; ++row) {
      rotated[row] = entries[3 * row] * vector[0] + entries[3 * row + 1] * vector[1] +
                     entries[3 * row + 2] * vector[2];
    }
  }
  void shift(FourFloats (&vector)[3]) const {
    for (int row = 0; row < 3; ++row) vector[row] += entries[9 + row];
  }
};

// Four firings of a channel that fires a share of the firing period later.
FourPoses delayed(FourPoses poses, const FourPoses& next, float share) {
  for (int i = 0; i < 12; ++i) {
    poses.entries[i] += share * (next.entries[i] - poses.entries[i]);
  }
  return poses;
}

BlockPoses block_poses(const Trajectory& trajectory, const Isometry3d& body_from_sensor,
                       double start, double firing_period, const Vector3d& origin) {
  constexpr int firings = firings_in_block;
  const double duration = firing_period * firings;
  const int spans = std::clamp(static_cast<int>(std::ceil(duration / pose_spacing)), 1, firings);
  float knots[firings + 1][12];
  for (int i = 0; i <= spans; ++i) {
    const Isometry3d pose = trajectory.pose(start + duration * i / spans) * body_from_sensor;
    for (int entry = 0; entry < 9; ++entry) {
      knots[i][entry] = static_cast<float>(pose.linear()(entry / 3, entry % 3));
    }
    for (int axis = 0; axis < 3; ++axis) {
      knots[i][9 + axis] = static_cast<float>(pose.translation()[axis] - origin[axis]);
    }
  }
  BlockPoses poses = {};
  for (int firing = 0; firing <= firings; ++firing) {
    const int knot = std::min(firing * spans / firings, spans - 1);
    const float share =
        static_cast<float>(firing * spans) / static_cast<float>(firings) - static_cast<float>(knot);
    for (int entry = 0; entry < 12; ++entry) {
      poses.entries[entry][firing] =
          knots[knot][entry] + share * (knots[knot + 1][entry] - knots[knot][entry]);
    }
  }
  return poses;
}

// Directions across a beam, along azimuth and along elevation; `up` is the sensor's z axis.
struct AcrossBeam {
  Vector3f horizontal, vertical;
};
AcrossBeam across(const Vector3f& direction, const Vector3f& up) {
  const Vector3f sideways = up.cross(direction);
  const float length = sideways.norm();
  const Vector3f horizontal =
      length > 1e-6F ? Vector3f(sideways / length) : direction.unitOrthogonal();
  return {horizontal, direction.cross(horizontal)};
}

// Rays relative to the origin of Embree's scene, slot by slot.
struct Rays {
  std::vector<float> origin[3], direction[3];

  void resize(std::size_t rays) {
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis].resize(rays);
      direction[axis].resize(rays);
    }
  }
  Vector3f from(std::size_t ray) const { return {origin[0][ray], origin[1][ray], origin[2][ray]}; }
  Vector3f towards(std::size_t ray) const {
    return {direction[0][ray], direction[1][ray], direction[2][ray]};
  }
  Vector3f at(std::size_t ray, float range) const { return from(ray) + range * towards(ray); }
  void set_direction(std::size_t ray, const Vector3f& towards) {
    for (int axis = 0; axis < 3; ++axis) direction[axis][ray] = towards[axis];
  }
};

// What rays meet.
struct Hits {
  std::vector<int> active;    // which rays to cast: -1 or 0, as Embree wants it
  std::vector<float> range;   // negative: nothing
  std::vector<float> cosine;  // of the angle of incidence
  std::vector<std::uint32_t> triangle;

  void resize(std::size_t rays) {
    active.assign(rays, 0);
    range.assign(rays, -1.0F);
    cosine.resize(rays);
    triangle.resize(rays);
  }
};

template <int width>
void cast_rays(const Scene::Embree& embree, float reach, const Rays& rays, Hits& hits) {
  Packet<width> packet;
  const auto load = [](float* lanes, const std::vector<float>& values, std::size_t first) {
    std::memcpy(lanes, values.data() + first, width * sizeof(float));
  };
  for (std::size_t first = 0; first < hits.active.size(); first += width) {
    std::memcpy(packet.active, hits.active.data() + first, width * sizeof(int));
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
    float* const range = hits.range.data() + first;
    float* const cosine = hits.cosine.data() + first;
    std::memcpy(hits.triangle.data() + first, hit.primID, sizeof hit.primID);
    for (int lane = 0; lane < width; ++lane) {
      const float projection = ray.dir_x[lane] * hit.Ng_x[lane] + ray.dir_y[lane] * hit.Ng_y[lane] +
                               ray.dir_z[lane] * hit.Ng_z[lane];
      const float square = hit.Ng_x[lane] * hit.Ng_x[lane] + hit.Ng_y[lane] * hit.Ng_y[lane] +
                           hit.Ng_z[lane] * hit.Ng_z[lane];
      range[lane] = packet.is_hit(lane) ? ray.tfar[lane] : -1.0F;
      cosine[lane] = std::abs(projection) / std::sqrt(square);
    }
  }
}

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
    if (config_.errors.angle_sigma > 0.0) mislead();
    reserve(returns);
    for (std::uint32_t firing = first; firing < end; ++firing) {
      for (std::size_t channel = 0; channel < config_.channels.size(); ++channel) {
        const std::size_t slot = lidar_.pattern.slot(firing, channel);
        if (shots_.is_shot[slot] == 0) continue;
        const double time =
            start + firing * config_.firing_period + config_.channels[channel].delay;
        report(channel, slot, time, returns);
      }
    }
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
    const Vector3f right =
        static_cast<float>(0.5 * config_.beam.divergence_horizontal) * sides.horizontal;
    const Vector3f above =
        static_cast<float>(0.5 * config_.beam.divergence_vertical) * sides.vertical;
    std::size_t ray = slot * lidar_.beam.size();
    for (const BeamSample& sample : lidar_.beam) {
      const Vector3f towards = axis + sample.horizontal * right + sample.vertical * above;
      beam_rays_.set_direction(ray, towards.normalized());
      for (int i = 0; i < 3; ++i) beam_rays_.origin[i][ray] = shots_rays_.origin[i][slot];
      ++ray;
    }
  }

  // Turns the rays along which the sensor reports its points by the errors of its angles.
  void mislead() {
    if (!has_own_belief_) reported_rays_ = shots_rays_;
    const auto sigma = static_cast<float>(config_.errors.angle_sigma);
    const BlockPoses& poses = has_own_belief_ ? believed_ : poses_;
    for (std::uint32_t firing = 0; firing < firings_in_block; ++firing) {
      for (std::size_t channel = 0; channel < config_.channels.size(); ++channel) {
        const std::size_t slot = lidar_.pattern.slot(firing, channel);
        const Vector3f direction = reported_rays_.towards(slot);
        const AcrossBeam sides = across(direction, up(poses, firing));
        reported_rays_.set_direction(slot,
                                     (direction + sigma * azimuth_noise_[slot] * sides.horizontal +
                                      sigma * elevation_noise_[slot] * sides.vertical)
                                         .normalized());
      }
    }
  }

  // Room for a block more. Growing by hand keeps the vectors' doubling.
  void reserve(LidarReturns& returns) const {
    const std::size_t needed = returns.size() + lidar_.pattern.slots();
    if (needed <= returns.points.capacity()) return;
    const std::size_t room = std::max(needed, 2 * returns.points.capacity());
    returns.points.reserve(room);
    returns.true_points.reserve(room);
    returns.times.reserve(room);
    returns.intensities.reserve(room);
    returns.scan_angles.reserve(room);
    returns.triangles.reserve(room);
    returns.channels.reserve(room);
    returns.return_numbers.reserve(room);
    returns.returns_of_shots.reserve(room);
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
    if (hits_.range[ray] < lidar_.min_range) return std::nullopt;
    return RayHit{hits_.range[ray], std::min(1.0F, hits_.cosine[ray]),
                  scene_.reflectance(hits_.triangle[ray]), share, hits_.triangle[ray]};
  }

  void report(std::size_t channel, std::size_t slot, double time, LidarReturns& returns) {
    const std::size_t samples = lidar_.beam.size();
    if (samples == 1) {
      const auto only = hit(slot, 1.0F);
      if (!only) return;
      const float power = received_power(*only, config_.sensitivity);
      if (power < 1.0F) return;
      const Echo echo = {only->range, only->cosine, only->reflectance * only->cosine, power,
                         only->triangle};
      report(echo, 0, 1, channel, slot, time, returns);
      return;
    }
    beam_hits_.clear();
    for (std::size_t i = 0; i < samples; ++i) {
      const auto one = hit(slot * samples + i, lidar_.beam[i].share);
      if (one) beam_hits_.push_back(*one);
    }
    const std::vector<Echo> echoes = form_echoes(beam_hits_, config_.sensitivity, config_.beam);
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      report(echoes[i], i, echoes.size(), channel, slot, time, returns);
    }
  }

  void report(const Echo& echo, std::size_t number, std::size_t count, std::size_t channel,
              std::size_t slot, double time, LidarReturns& returns) const {
    const RangeErrors& errors = config_.errors;
    float range = echo.range + lidar_.biases[channel];
    if (has_range_noise_) {
      const float sigma = lidar_.has_constant_sigma ? static_cast<float>(errors.sigma)
                                                    : range_sigma(errors, echo.range, echo.cosine);
      range += sigma * range_noise_[number][slot];
    }
    if (errors.range_step > 0.0) {
      range = static_cast<float>(std::round(range / errors.range_step) * errors.range_step);
    }
    const bool reports_otherwise = has_own_belief_ || errors.angle_sigma > 0.0;
    returns.points.push_back((reports_otherwise ? reported_rays_ : shots_rays_).at(slot, range));
    returns.true_points.push_back(shots_rays_.at(slot, echo.range));
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
  Rays shots_rays_;     // the axes of the shots as they were
  Rays reported_rays_;  // and as the sensor and its carrier believe; only if they differ
  Rays beam_rays_;      // of beams with a width
  Hits hits_;
  std::vector<float> azimuth_noise_, elevation_noise_;
  std::vector<std::vector<float>> range_noise_;  // for each return of a shot
  std::vector<RayHit> beam_hits_;
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
