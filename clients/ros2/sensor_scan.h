/// Clouds and depth images of ROS as scans that `skycap serve` takes
/// (docs/reference/live-protocol.md).
///
/// All lengths and counts of a message are checked before its bytes are looked at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "clients/ros2/frames.h"
#include "clients/ros2/messages.h"

namespace skycap::ros2 {

/// x y z after x y z in the sensor's optical frame [m].
struct CloudScan {
  std::vector<float> xyz;
};

struct DepthScan {
  std::vector<std::uint16_t> depth;  ///< row after row; 0 and 65535 are no return
  int width = 0, height = 0;
  double unit = 0.001;       ///< [m], as REP-118 has it
  std::vector<double> lens;  ///< fx fy cx cy, maybe k1 k2 p1 p2 k3
};

using SensorScan = std::variant<CloudScan, DepthScan>;

/// The points of a cloud, organised or not, whose fields x, y, z are FLOAT32 or FLOAT64. Left out:
/// points that are none (NaN, infinite) and those at the sensor itself, which is how drivers write
/// no return. Throws Error{bad_geometry} saying what is wrong with the message.
CloudScan scan_of(const PointCloud2& cloud, Axes axes);

/// What a camera's CameraInfo says of its pixels.
struct CameraLens {
  std::uint32_t width = 0, height = 0;
  std::vector<double> lens;  ///< as of DepthScan

  bool is_distorted() const { return lens.size() > 4; }
};

/// Of the raw image by K and D, or of a rectified one by P. Throws Error{bad_geometry} for binning,
/// regions of interest, and lenses other than plumb_bob with k1 k2 p1 p2 k3.
CameraLens lens_of(const CameraInfo& info, bool is_rectified);

/// A depth image: 16UC1 or mono16 in millimetres as it is; 32FC1 in metres as a cloud, for which
/// the lens must have no distortion. Throws Error{bad_geometry}.
SensorScan scan_of(const Image& image, const CameraLens& lens);

}  // namespace skycap::ros2
