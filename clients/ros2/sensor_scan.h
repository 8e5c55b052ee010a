/// Converts ROS clouds and depth images to scans for `skycap serve`
/// (docs/reference/live-protocol.md).
///
/// All lengths and counts of a message are validated before its data are accessed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "clients/ros2/frames.h"
#include "clients/ros2/messages.h"

namespace skycap::ros2 {

/// Consecutive x y z in the sensor's optical frame [m].
struct CloudScan {
  std::vector<float> xyz;
};

struct DepthScan {
  std::vector<std::uint16_t> depth;  ///< Row by row. 0 and 65535 are no-return values.
  int width = 0, height = 0;
  double unit = 0.001;             ///< Depth step [m], according to REP-118.
  std::vector<double> intrinsics;  ///< fx fy cx cy, optionally followed by k1 k2 p1 p2 k3.
};

using SensorScan = std::variant<CloudScan, DepthScan>;

/// Returns the points of a cloud, organised or not, whose fields x, y, z are FLOAT32 or FLOAT64.
/// Skips points that are not finite, and points at the sensor origin, which drivers use for no
/// return. Throws Error{bad_geometry} with the problem of the message.
CloudScan make_scan(const PointCloud2& cloud, Axes axes);

/// Camera intrinsics from a CameraInfo message.
struct CameraIntrinsics {
  std::uint32_t width = 0, height = 0;
  std::vector<double> intrinsics;  ///< In the format of DepthScan.

  bool is_distorted() const { return intrinsics.size() > 4; }
};

/// Returns the intrinsics of the raw image (K and D) or of a rectified one (P). Throws
/// Error{bad_geometry} for binning, regions of interest, and distortion models other than plumb_bob
/// with k1 k2 p1 p2 k3.
CameraIntrinsics to_intrinsics(const CameraInfo& info, bool is_rectified);

/// Returns a depth image for 16UC1 or mono16 (millimetres), and a cloud for 32FC1 (metres), which
/// must have no distortion. Throws Error{bad_geometry}.
SensorScan make_scan(const Image& image, const CameraIntrinsics& intrinsics);

}  // namespace skycap::ros2
