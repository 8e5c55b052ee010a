/// Scan reduced to blocks of neighbouring rays, on which the planner operates.
///
/// With B = 4, the mean of a block of B x B pixels has a quarter of the noise of a pixel.
/// Processing blocks is two hundred times faster than processing their pixels. The spread within a
/// block shows the noise. A pinhole image is converted to one block image. A sweep without an
/// image, such as that of a LiDAR, is converted to a range image of the sphere. It consists of six
/// faces of a cube around the sensor, each a pinhole image with an angle of 90 degrees. Blocks are
/// numbered in row-major order.
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

#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"

namespace skycap::survey::surfel {

/// Projection of a point onto a grid of blocks.
struct BlockHit {
  std::uint32_t block;
  float depth;  ///< along the optical axis [m]
};

/// Pinhole projection onto blocks. The coordinates of a block start at 0 at its left or upper edge.
struct BlockProjection {
  int columns = 0, rows = 0;
  Eigen::Matrix3f sensor_from_world = Eigen::Matrix3f::Identity();  ///< rotation only
  Eigen::Vector3f sensor_position = Eigen::Vector3f::Zero();        ///< world frame [m]
  Eigen::Vector2f focal_length = Eigen::Vector2f::Ones();           ///< [blocks]
  Eigen::Vector2f principal_point = Eigen::Vector2f::Zero();        ///< [blocks]

  /// Returns the row-major number of a block.
  std::size_t block_index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  /// Returns the block of a point in the world frame, or nullopt if the point is outside the image.
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

/// Returns of one block. Depths are along the optical axis [m].
struct Block {
  std::uint32_t returns = 0;  ///< number of returns; for an edge, those of the nearer group only
  bool is_edge = false;       ///< contains a depth discontinuity; farther returns are ignored
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();    ///< world frame [m]
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit vector towards the sensor
  float depth = 0.0F;                                ///< mean depth
  float min_depth = std::numeric_limits<float>::infinity();
  float depth_deviation = 0.0F;  ///< standard deviation of the depths
  /// Reliability of the normal, from 0 to 1. High for frontal views of the interior of a surface
  /// without edges.
  float quality = 0.0F;
  float residual = 0.0F;  ///< standard deviation across the surface [m]; 0 if unknown
  /// Whether rays are known to cover the whole block, so that a missing return is a miss.
  bool is_scanned = true;
};

struct BlockImage {
  BlockProjection projection;
  std::vector<Block> blocks;
  /// Whether the sensor's range is limited along the ray rather than along the optical axis.
  bool has_radial_range = false;

  /// Returns the ray density [rays per m^2] on a surface that the returns of `block` hit at the
  /// given cosine of incidence.
  float ray_density(const Block& block, const Eigen::Vector3f& point, float cos_incidence) const;
};

struct BlockSettings {
  int block_px = 4;      ///< B: block width [px]
  float jump = 0.05F;    ///< J: depth spread above which a block is an edge [m]
  unsigned threads = 1;  ///< zero: all processors
};

/// Resolution of the scene model.
struct Scale {
  double surfel;    ///< h: distance between surfels [m]
  int block_px;     ///< B: block width [px]
  double min_jump;  ///< minimum J, independent of the noise [m]
};

/// Derives the resolution from the extent of the scene [m] and the pixel spacing at the view
/// distance [m]. `surfel` is the user's value of h, if any.
Scale make_scale(double extent, double pixel, std::optional<double> surfel);

/// Converts an organised scan to a block image.
BlockImage make_block_image(const geometry::ScanSpan& scan, const geometry::Camera& camera,
                            const BlockSettings& settings);

/// Converts a scan without an image to the front face and all other faces that contain a return.
/// Each face has `face_blocks` x `face_blocks` blocks. The sensor is assumed to sample the field of
/// view of `camera` with at least one ray per block; the axis of `camera` is that of the front
/// face. Outside this field of view, only the returns are used.
std::vector<BlockImage> make_cube_images(const geometry::ScanSpan& scan,
                                         const geometry::Camera& camera, int face_blocks,
                                         const BlockSettings& settings);

/// Converts any scan: an organised scan to one image, another scan to cube faces whose blocks have
/// the width of the camera's blocks.
std::vector<BlockImage> make_block_images(const geometry::ScanSpan& scan,
                                          const geometry::Camera& camera,
                                          const BlockSettings& settings);

}  // namespace skycap::survey::surfel
