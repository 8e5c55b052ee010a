/// Interface of the rawlog module.
///
/// The MRPT libraries depend on about 170 others, which take 0.2 s to load. They are therefore
/// linked into a separate module that is loaded on demand.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/points/depth_image.h"
#include "missions/scan/cloud_file.h"
#include "sim/sensors/sensor.h"

namespace skycap::missions::scan {

/// Motion of a sensor, actual or estimated.
struct SensorMotion {
  std::function<Eigen::Isometry3d(double time)> world_from_platform;
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
};

struct RawlogSetup {
  std::string sensor_name;
  sim::LidarConfig sensor;
  double start = 0.0;  ///< Time of firing 0 [s].
  SensorMotion reported, actual;
};

/// Image of a depth camera. The sensor frame has x forward, y left, z up, as in MRPT.
struct DepthFrame {
  double time = 0.0;  ///< [s]
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();
  const geometry::DepthImage& image;
  Eigen::Vector2d focal_length_px, principal_point_px;
  double unit = 0.001;     ///< Depth per unit of a pixel value [m].
  double max_range = 0.0;  ///< [m]
};

/// Entry points of the module. The caller owns the format returned by MakeRawlogFormat.
/// EncodeDepthFrame replaces `bytes` by a CObservationRobotPose with the pose of the sensor and a
/// CObservation3DRangeScan "DEPTH".
using EncodeDepthFrame = void(const DepthFrame& frame, std::vector<std::uint8_t>& bytes);
inline constexpr const char* encode_depth_frame_name = "skycap_encode_depth_frame";
using MakeRawlogFormat = CloudFormat*(const RawlogSetup& setup);
inline constexpr const char* make_rawlog_format_name = "skycap_make_rawlog_format";

}  // namespace skycap::missions::scan
