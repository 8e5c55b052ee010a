/// A scan reduced to blocks of neighbouring rays: the unit in which the planner thinks.
///
/// A block of B x B pixels measures a place a quarter as noisily (B = 4) and two hundred times
/// faster than its pixels would, and its spread tells the noise. A pinhole image gives one block
/// image; a sweep without an image (a LiDAR's) becomes a range image of the whole sphere: the six
/// faces of a cube about the sensor, each of which is a pinhole image of a right angle. Blocks are
/// numbered row by row.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/place/camera.h"
#include "geometry/points/scan.h"

namespace skycap::survey::skycap {

/// Where a point falls in a grid of blocks.
struct BlockHit {
  std::uint32_t block;
  float depth;  ///< along the optical axis
};

/// The pinhole projection onto blocks. A block's coordinates run from 0 at its left or upper edge.
struct BlockProjection {
  int columns = 0, rows = 0;
  Eigen::Matrix3f sensor_from_world = Eigen::Matrix3f::Identity();  ///< rotation only
  Eigen::Vector3f sensor_position = Eigen::Vector3f::Zero();        ///< world frame
  Eigen::Vector2f focal_length = Eigen::Vector2f::Ones();           ///< [blocks]
  Eigen::Vector2f principal_point = Eigen::Vector2f::Zero();        ///< [blocks]

  /// The number of a block, row by row.
  std::size_t number_of(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  /// The block that a point in the world falls into; nothing outside the image.
  std::optional<BlockHit> project(const Eigen::Vector3f& point) const {
    const Eigen::Vector3f in_sensor = sensor_from_world * (point - sensor_position);
    if (!(in_sensor.z() > 0.0F)) return std::nullopt;
    const float inverse = 1.0F / in_sensor.z();
    const float column = focal_length.x() * in_sensor.x() * inverse + principal_point.x();
    const float row = focal_length.y() * in_sensor.y() * inverse + principal_point.y();
    if (!(column >= 0.0F && row >= 0.0F && column < static_cast<float>(columns) &&
          row < static_cast<float>(rows))) {
      return std::nullopt;
    }
    return BlockHit{static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(columns) +
                        static_cast<std::uint32_t>(column),
                    in_sensor.z()};
  }
};

/// The returns of one block. Depths are along the optical axis.
struct Block {
  std::uint32_t returns = 0;  ///< of the nearer group if the block straddles a jump in depth
  bool is_edge = false;       ///< straddles a jump: what lies behind is left out
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();    ///< world frame
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, towards the sensor
  float depth = 0.0F;                                ///< mean
  float least_depth = std::numeric_limits<float>::infinity();
  float depth_deviation = 0.0F;  ///< standard deviation of the depths
  /// How far the normal can be relied on, 0 to 1: head-on, in the middle of a surface, no edge.
  float quality = 0.0F;
  float residual = 0.0F;  ///< standard deviation across the surface; 0 if not known
  /// Whether rays are known to have gone all over it, so that no return means a miss.
  bool is_shot_at = true;
};

struct BlockImage {
  BlockProjection projection;
  std::vector<Block> blocks;

  /// Rays per square metre of a surface that block returns met at the given cosine of incidence.
  float ray_density(const Block& block, const Eigen::Vector3f& point, float cos_incidence) const;
};

struct BlockSettings {
  int block_px = 4;      ///< B [px]
  float jump = 0.05F;    ///< J: a larger spread of depths in a block is an edge
  unsigned threads = 1;  ///< zero: all processors
};

/// How finely a scene is told.
struct Scale {
  double surfel;      ///< h, from one to the next [m]
  int block_px;       ///< B
  double least_jump;  ///< that is an edge whatever the noise [m]
};

/// Of a scene of that extent whose pixels are so far apart at the view distance [m]; `surfel`, if
/// given, is what the user wants.
Scale scale_of(double extent, double pixel, std::optional<double> surfel);

/// The block image of an organised scan.
BlockImage make_block_image(const geometry::ScanSpan& scan, const geometry::Camera& camera,
                            const BlockSettings& settings);

/// The face in front, and those others that hold a return, of a scan without an image;
/// `face_blocks` x `face_blocks` blocks each. The sensor is known to shoot everywhere into the view
/// of `camera`, whose axis is that of the face in front, and that no less densely than once a
/// block; of what is beside, nothing is known but the returns.
std::vector<BlockImage> make_cube_images(const geometry::ScanSpan& scan,
                                         const geometry::Camera& camera, int face_blocks,
                                         const BlockSettings& settings);

/// Of any scan: its image, or without one the faces of a cube, whose blocks are as wide as those of
/// the camera's image.
std::vector<BlockImage> make_block_images(const geometry::ScanSpan& scan,
                                          const geometry::Camera& camera,
                                          const BlockSettings& settings);

}  // namespace skycap::survey::skycap
