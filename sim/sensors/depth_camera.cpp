#include "sim/sensors/depth_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/parallel.h"
#include "sim/scene/four_lanes.h"
#include "sim/scene/scene_trees.h"
#include "sim/scene/surface_effects.h"
#include "sim/sensors/frame_rays.h"
#include "sim/sensors/vector_kernels.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::Scan;

constexpr float no_return = -1.0F;
// Streams 0, 1, 2: x, y, z of the point noise.
constexpr std::uint32_t stereo_stream = 3, table_stream = 4;

// Standard deviations of the depths of a band from a noise table.
struct TableNoise {
  const NoiseTable& table;
  const Scene& scene;
};

// Limits of hits that give a return.
struct Limits {
  float min_depth, max_depth;
  float min_cosine;  // Minimum cosine of the angle of incidence. 0: no limit.
};

float compute_min_cosine(double max_incidence) {
  return max_incidence < 0.5 * std::numbers::pi ? static_cast<float>(std::cos(max_incidence))
                                                : 0.0F;
}

bool is_too_slanted(const RayPacket& packet, int lane, float min_cosine) {
  const auto extract_lane = [lane](const auto& vectors) {
    return Vector3f(vectors[0][lane], vectors[1][lane], vectors[2][lane]);
  };
  const Vector3f direction = extract_lane(packet.direction), normal = extract_lane(packet.normal);
  return std::abs(direction.dot(normal)) < min_cosine * direction.norm() * normal.norm();
}

// Writes the standard deviations of the depths of a packet. The noise is along the ray.
void store_sigmas(const RayPacket& packet, const TableNoise& noise, std::ptrdiff_t stride,
                  float* sigmas) {
  for (int lane = 0; lane < RayPacket::width; ++lane) {
    float& sigma = sigmas[lane / packet_columns * stride + lane % packet_columns];
    sigma = 0.0F;
    if (packet.distance[lane] < 0.0F) continue;
    const auto extract_lane = [lane](const auto& vectors) {
      return Vector3f(vectors[0][lane], vectors[1][lane], vectors[2][lane]);
    };
    const Vector3f direction = extract_lane(packet.direction), normal = extract_lane(packet.normal);
    const float length = direction.norm();
    const float cosine = std::abs(direction.dot(normal)) / (length * normal.norm());
    sigma = noise.table.sigma(packet.distance[lane] * length, cosine,
                              noise.scene.reflectance(packet.triangle[lane])) /
            length;
  }
}

void store_depths(const RayPacket& packet, const Limits& limits, std::ptrdiff_t stride,
                  float* depths) {
  const FourFloats none = FourFloats{} + no_return;
  for (std::ptrdiff_t row = 0; row < packet_rows; ++row) {
    const auto hit = four<FourFloats>(packet.distance + row * packet_columns);
    // A camera that touches a surface hits it at a distance of +0 or -0. This is not a return.
    const FourFloats depth = ((hit >= limits.min_depth) & (hit > 0.0F)) ? hit : none;
    std::memcpy(depths + row * stride, &depth, sizeof depth);
  }
  if (limits.min_cosine <= 0.0F) return;
  for (int lane = 0; lane < RayPacket::width; ++lane) {
    if (packet.distance[lane] >= 0.0F && is_too_slanted(packet, lane, limits.min_cosine)) {
      depths[lane / packet_columns * stride + lane % packet_columns] = no_return;
    }
  }
}

// Calls `work` with the first column and row of each packet of a tile.
template <typename Work>
void for_each_packet(int left, int right, int top, int bottom, const Work& work) {
  for (int row = top; row < bottom; row += packet_rows) {
    for (int column = left; column < right; column += packet_columns) work(column, row);
  }
}

// Casts the rays of one band of the image. The depths are written to `depths` row by row with the
// table's stride. Rays of the padding are copies, and their depths are never read. Standard
// deviations are written to `sigmas` if there is a noise table.
template <typename Rays>
void cast_band(const Scene::Trees& trees, const RayTable& table, const Rays& rays,
               const Limits& limits, int first_row, float* depths, const TableNoise* noise,
               float* sigmas) {
  std::array<RayPacket, packets_in_tile> packets;
  for (RayPacket& packet : packets) rays.begin(packet);
  const RayKernels& kernels = ray_kernels();
  const bool needs_surface = limits.min_cosine > 0.0F || noise != nullptr;
  const auto cast = needs_surface ? kernels.cast_tile : kernels.cast_tile_distances;
  const int rows = std::min(band_rows, table.height - first_row);
  const std::ptrdiff_t stride = table.stride;
  for (int top = 0; top < rows; top += tile_rows) {
    for (int left = 0; left < table.width; left += tile_columns) {
      const int bottom = std::min(top + tile_rows, rows);
      const int right = std::min(left + tile_columns, table.width);
      int count = 0;
      for_each_packet(left, right, top, bottom, [&](int column, int row) {
        rays.aim(column, first_row + row, packets[count++]);
      });
      if (trees.surfaces.empty()) {
        cast(trees.target, packets.data(), count, limits.max_depth);
      } else {
        for (int i = 0; i < count; ++i) {
          cast_at_surfaces(trees, packets[i], RayPacket::all_lanes, limits.max_depth);
        }
      }
      count = 0;
      for_each_packet(left, right, top, bottom, [&](int column, int row) {
        const RayPacket& packet = packets[count++];
        store_depths(packet, limits, stride, depths + row * stride + column);
        if (noise != nullptr) {
          store_sigmas(packet, *noise, stride, sigmas + row * stride + column);
        }
      });
    }
  }
}

// Casts one band of an image exposed in motion. A pixel's depth is the mean of its instants with a
// return, which must be at least half of all. If they belong to different surfaces, there is no
// return, because drivers discard such mixed pixels.
void cast_moving_band(const Scene::Trees& trees, const RayTable& table,
                      const std::vector<MovingRays>& instants, const Limits& limits, int first_row,
                      float* depths, const TableNoise* noise, float* sigmas) {
  constexpr float one_surface = 1.02F;  // Maximum ratio of depths on one surface.
  const std::size_t size = static_cast<std::size_t>(table.stride) * band_rows;
  std::vector<float> one(size, no_return), sums(size, 0.0F), counts(size, 0.0F);
  std::vector<float> min(size, std::numeric_limits<float>::infinity()), max(size, 0.0F);
  std::vector<float> sigma(noise != nullptr ? size : 0), sigma_sums(sigma);
  for (const MovingRays& rays : instants) {
    cast_band(trees, table, rays, limits, first_row, one.data(), noise, sigma.data());
    for (std::size_t i = 0; i < size; ++i) {
      if (one[i] < 0.0F) continue;
      if (noise != nullptr) sigma_sums[i] += sigma[i];
      sums[i] += one[i];
      counts[i] += 1.0F;
      min[i] = std::min(min[i], one[i]);
      max[i] = std::max(max[i], one[i]);
    }
  }
  for (std::size_t i = 0; i < size; ++i) {
    const bool is_seen =
        counts[i] > 0.0F && 2.0F * counts[i] >= static_cast<float>(instants.size());
    depths[i] = is_seen && max[i] <= one_surface * min[i] ? sums[i] / counts[i] : no_return;
    if (noise != nullptr) sigmas[i] = is_seen ? sigma_sums[i] / counts[i] : 0.0F;
  }
}

// Assigns the position of each band in the scan. Bands are cast in any order but their points are
// consecutive, so a band must wait until all previous ones are counted.
class BandOffsets {
 public:
  struct BandOffset {
    std::size_t band;
    std::size_t first_point;
  };

  explicit BandOffsets(std::size_t bands) : returns_(bands) {}

  /// Counts a band. Returns the bands whose position becomes known.
  std::vector<BandOffset> count(std::size_t band, std::size_t returns) {
    const std::lock_guard lock(mutex_);
    returns_[band] = returns;
    std::vector<BandOffset> known;
    for (; next_ < returns_.size() && returns_[next_]; ++next_) {
      known.push_back({next_, points_});
      points_ += *returns_[next_];
    }
    return known;
  }

  /// Returns the number of points of all positioned bands.
  std::size_t points() const { return points_; }

 private:
  std::mutex mutex_;
  std::vector<std::optional<std::size_t>> returns_;
  std::size_t next_ = 0;
  std::size_t points_ = 0;
};

// Replaces the depths of one band by those of triangulation.
void add_stereo_errors(const RayTable& table, const StereoErrors& stereo, const NoiseKey& key,
                       int first_row, float* depths) {
  const auto product = static_cast<float>(stereo.focal_length_px * stereo.baseline);
  const auto sigma = static_cast<float>(stereo.disparity_sigma_px);
  const auto step = static_cast<float>(stereo.disparity_step_px);
  std::vector<float> normals(table.stride);
  for (int y = first_row; y < std::min(first_row + band_rows, table.height); ++y) {
    float* const row = depths + static_cast<std::size_t>(y - first_row) * table.stride;
    fill_normals(key, static_cast<std::uint32_t>(y) * table.stride, normals);
    for (int x = 0; x < table.width; ++x) {
      if (row[x] <= 0.0F) continue;
      float disparity = product / row[x] + sigma * normals[x];
      if (step > 0.0F) disparity = std::round(disparity / step) * step;
      row[x] = disparity > 0.0F ? product / disparity : no_return;
    }
  }
}

// Adds the noise of a table to the depths of one band.
void add_table_noise(const RayTable& table, const NoiseKey& key, int first_row, const float* sigmas,
                     float* depths) {
  std::vector<float> normals(table.stride);
  for (int y = first_row; y < std::min(first_row + band_rows, table.height); ++y) {
    const std::size_t begin = static_cast<std::size_t>(y - first_row) * table.stride;
    fill_normals(key, static_cast<std::uint32_t>(y) * table.stride, normals);
    for (int x = 0; x < table.width; ++x) {
      float& depth = depths[begin + x];
      if (depth <= 0.0F) continue;
      depth += sigmas[begin + x] * normals[x];
      if (depth <= 0.0F) depth = no_return;
    }
  }
}

std::size_t count_returns(const RayTable& table, int first_row, const float* depths) {
  const int rows = std::min(band_rows, table.height - first_row);
  std::size_t returns = 0;
  for (int row = 0; row < rows; ++row) {
    const float* const row_depths = depths + static_cast<std::size_t>(row) * table.stride;
    FourInts in_row = {};
    int x = 0;
    for (; x + 4 <= table.width; x += 4) {
      FourFloats some;
      std::memcpy(&some, row_depths + x, sizeof some);
      in_row -= some >= 0.0F;
    }
    for (; x < table.width; ++x) in_row[0] += row_depths[x] >= 0.0F ? 1 : 0;
    returns += sum(in_row);
  }
  return returns;
}

// Returns the row-independent input of the kernel that converts depths to points.
PinholeRow row_template(const RayTable& table, const Vector3d& position, const NoiseConfig& noise,
                        std::uint64_t frame) {
  PinholeRow row{};
  row.width = static_cast<std::size_t>(table.width);
  for (int axis = 0; axis < 3; ++axis) {
    row.column[axis] = table.columns[axis].data();
    row.origin[axis] = static_cast<float>(position[axis]);
    row.noise_keys[axis] = noise_key(noise.seed, axis, frame);
  }
  row.sigma = static_cast<float>(noise.sigma);
  row.noise_direction = noise.direction;
  return row;
}

// Writes the points of one band to their position.
void emit_band(const RayTable& table, PinholeRow row, int first_row, const float* depths,
               std::size_t first_point, Scan& scan) {
  static_assert(sizeof(Vector3f) == 3 * sizeof(float));
  std::size_t next = first_point;
  for (int y = first_row; y < std::min(first_row + band_rows, table.height); ++y) {
    row.depth = depths + static_cast<std::size_t>(y - first_row) * table.stride;
    for (int axis = 0; axis < 3; ++axis) row.row[axis] = table.rows[axis][y];
    row.first_pixel = static_cast<std::uint32_t>(y) * table.width;
    row.noise_index = static_cast<std::uint32_t>(y) * table.stride;
    if (next == scan.points.size()) return;  // No returns are left.
    next += vector_kernels().emit_row(row, scan.points[next].data(), &scan.pixels[next]);
  }
}

// Returns the frame from `world_from_camera`. `cast` computes the depths of a band, and their
// standard deviations if there is a noise table.
template <typename Cast>
Scan make_frame(const DepthCameraConfig& config, const RayTable& table,
                const Eigen::Isometry3d& world_from_camera, std::uint64_t frame, unsigned threads,
                Scan buffer, const Cast& cast) {
  const PinholeRow row = row_template(table, world_from_camera.translation(), config.noise, frame);
  Scan scan = std::move(buffer);
  scan.world_from_sensor = world_from_camera;
  const auto pixels = static_cast<std::size_t>(table.width) * table.height;
  scan.points.resize(pixels);
  scan.pixels.resize(pixels);
  const std::size_t band_size = static_cast<std::size_t>(table.stride) * band_rows;
  const std::size_t bands = (table.height + band_rows - 1) / band_rows;
  const auto depths = std::make_unique_for_overwrite<float[]>(bands * band_size);
  BandOffsets offsets(bands);
  geometry::parallel_for(bands, threads, [&](std::size_t band) {
    const int first_row = static_cast<int>(band) * band_rows;
    float* const band_depths = depths.get() + band * band_size;
    std::vector<float> sigmas(config.noise.table.is_on() ? band_size : 0);
    cast(first_row, band_depths, sigmas.data());
    if (config.stereo.is_on()) {
      const NoiseKey key = noise_key(config.noise.seed, stereo_stream, frame);
      add_stereo_errors(table, config.stereo, key, first_row, band_depths);
    }
    if (config.noise.table.is_on()) {
      const NoiseKey key = noise_key(config.noise.seed, table_stream, frame);
      add_table_noise(table, key, first_row, sigmas.data(), band_depths);
    }
    const std::size_t returns = count_returns(table, first_row, band_depths);
    for (const auto& [known, first_point] : offsets.count(band, returns)) {
      emit_band(table, row, static_cast<int>(known) * band_rows, depths.get() + known * band_size,
                first_point, scan);
    }
  });
  scan.points.resize(offsets.points());
  scan.pixels.resize(offsets.points());
  return scan;
}

Limits make_limits(const DepthCameraConfig& config) {
  return {static_cast<float>(config.camera.min_range), static_cast<float>(config.camera.max_range),
          compute_min_cosine(config.max_incidence)};
}

}  // namespace

DepthCamera::DepthCamera(const DepthCameraConfig& config)
    : config_(config), camera_(config.camera) {
  config.validate();
}

Scan DepthCamera::scan(const Scene& scene, const Eigen::Isometry3d& world_from_camera,
                       std::uint64_t frame, unsigned threads, Scan buffer) const {
  const Scene::Trees& trees = scene.trees();
  const RayTable table(camera_, world_from_camera, trees.centre);
  const TableNoise noise{config_.noise.table, scene};
  const TableNoise* const table_noise = config_.noise.table.is_on() ? &noise : nullptr;
  return make_frame(
      config_, table, world_from_camera, frame, threads, std::move(buffer),
      [&, limits = make_limits(config_)](int first_row, float* depths, float* sigmas) {
        cast_band(trees, table, table, limits, first_row, depths, table_noise, sigmas);
      });
}

Scan DepthCamera::scan(const Scene& scene, const Eigen::Isometry3d& estimated,
                       const FrameMotion& motion, std::uint64_t frame, unsigned threads,
                       Scan buffer) const {
  const Scene::Trees& trees = scene.trees();
  const RayTable table(camera_, estimated, trees.centre);
  std::vector<MovingRays> instants;
  instants.reserve(static_cast<std::size_t>(motion.instants));
  for (int i = 0; i < motion.instants; ++i) {
    instants.emplace_back(camera_, motion, i, trees.centre);
  }
  const TableNoise noise{config_.noise.table, scene};
  const TableNoise* const table_noise = config_.noise.table.is_on() ? &noise : nullptr;
  return make_frame(
      config_, table, estimated, frame, threads, std::move(buffer),
      [&, limits = make_limits(config_)](int first_row, float* depths, float* sigmas) {
        cast_moving_band(trees, table, instants, limits, first_row, depths, table_noise, sigmas);
      });
}

Scan DepthCamera::scan(const Scene& scene, const geometry::View& view, std::uint64_t frame,
                       unsigned threads, Scan buffer) const {
  return scan(scene, geometry::camera_pose(view), frame, threads, std::move(buffer));
}

}  // namespace skycap::sim
