/// Rays of a depth camera frame as ray packets, for a stationary or a moving camera.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/pose/camera.h"
#include "sim/scene/four_lanes.h"
#include "sim/scene/ray_kernels.h"
#include "sim/sensors/depth_camera_config.h"

namespace skycap::sim {

/// Columns of a ray packet.
inline constexpr int packet_columns = 4;
inline constexpr int packet_rows = RayPacket::width / packet_columns;
/// Tile of packets that are cast together.
inline constexpr int tile_columns = 16, tile_rows = 16;
inline constexpr int packets_in_tile = tile_columns * tile_rows / RayPacket::width;
inline constexpr int band_rows = 32;  ///< Rows of a band of tiles, which is one task of a thread.

inline constexpr int column_block = 32;  ///< Columns whose noise is drawn together.

inline int rounded_up(int value, int multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

/// Rays of an image from one pose, in world axes and with depth 1. A ray is the sum of a column
/// vector and a row vector. Rows are padded to full bands, and columns with copies of the last one
/// to full blocks.
struct RayTable {
  int width, height;
  int stride;
  std::array<std::vector<float>, 3> columns;
  std::array<std::vector<float>, 3> rows;
  Eigen::Vector3f origin;  ///< Relative to the centre of the scene's trees.

  RayTable(const geometry::Camera& camera, const Eigen::Isometry3d& world_from_camera,
           const Eigen::Vector3d& scene_centre);

  /// Sets the part that all packets share.
  void begin(RayPacket& packet) const {
    for (int axis = 0; axis < 3; ++axis) {
      for (float& lane : packet.origin[axis]) lane = origin[axis];
    }
  }

  void aim(int first_column, int first_row, RayPacket& packet) const {
    for (int axis = 0; axis < 3; ++axis) {
      FourFloats four_columns;
      std::memcpy(&four_columns, columns[axis].data() + first_column, sizeof four_columns);
      const float* const row = rows[axis].data() + first_row;
      for (std::ptrdiff_t y = 0; y < packet_rows; ++y) {
        put_four(packet.direction[axis] + y * packet_columns, four_columns + row[y]);
      }
    }
  }
};

/// Rays at one instant of each row's exposure, each row with its own camera pose.
class MovingRays {
 public:
  MovingRays(const geometry::Camera& camera, const FrameMotion& motion, int instant,
             const Eigen::Vector3d& scene_centre);

  void begin(RayPacket& /*packet*/) const {}

  void aim(int first_column, int first_row, RayPacket& packet) const {
    FourFloats slopes;
    std::memcpy(&slopes, slopes_.data() + first_column, sizeof slopes);
    for (int axis = 0; axis < 3; ++axis) {
      for (std::ptrdiff_t y = 0; y < packet_rows; ++y) {
        const Row& row = rows_[first_row + y];
        put_four(packet.direction[axis] + y * packet_columns,
                 slopes * row.right[axis] + row.ahead[axis]);
        put_four(packet.origin[axis] + y * packet_columns, FourFloats{} + row.origin[axis]);
      }
    }
  }

 private:
  /// A ray is the slope of its column times `right`, plus `ahead`.
  struct Row {
    Eigen::Vector3f right, ahead, origin;
  };
  std::vector<float> slopes_;
  std::vector<Row> rows_;
};

inline RayTable::RayTable(const geometry::Camera& camera,
                          const Eigen::Isometry3d& world_from_camera,
                          const Eigen::Vector3d& scene_centre)
    : width(camera.width()),
      height(camera.height()),
      stride(rounded_up(width, column_block)),
      origin((world_from_camera.translation() - scene_centre).cast<float>()) {
  const Eigen::Matrix3d axes = world_from_camera.linear();
  for (int axis = 0; axis < 3; ++axis) {
    for (int x = 0; x < stride; ++x) {
      const double slope = camera.ray({std::min(x, width - 1), 0}).x();
      columns[axis].push_back(static_cast<float>(slope * axes(axis, 0) + axes(axis, 2)));
    }
    for (int y = 0; y < rounded_up(height, band_rows); ++y) {
      const double slope = camera.ray({0, std::min(y, height - 1)}).y();
      rows[axis].push_back(static_cast<float>(slope * axes(axis, 1)));
    }
  }
}

inline MovingRays::MovingRays(const geometry::Camera& camera, const FrameMotion& motion,
                              int instant, const Eigen::Vector3d& scene_centre) {
  const int width = camera.width(), height = camera.height();
  for (int x = 0; x < rounded_up(width, column_block); ++x) {
    slopes_.push_back(static_cast<float>(camera.ray({std::min(x, width - 1), 0}).x()));
  }
  const double in_exposure = ((instant + 0.5) / motion.instants - 0.5) * motion.exposure;
  for (int y = 0; y < rounded_up(height, band_rows); ++y) {
    const int row = std::min(y, height - 1);
    const double in_readout = ((row + 0.5) / height - 0.5) * motion.readout;
    const Eigen::Isometry3d pose = motion.pose(in_readout + in_exposure);
    const Eigen::Matrix3d axes = pose.linear();
    rows_.push_back({axes.col(0).cast<float>(),
                     (camera.ray({0, row}).y() * axes.col(1) + axes.col(2)).cast<float>(),
                     (pose.translation() - scene_centre).cast<float>()});
  }
}

}  // namespace skycap::sim
