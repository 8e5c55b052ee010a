/// What the rawlog module is told, and how it is entered.
///
/// MRPT's libraries bring 170 others that take 0.2 s to load. They are therefore linked into a
/// module of their own, which the program loads when somebody asks for a rawlog.
#pragma once

#include <functional>
#include <string>

#include <Eigen/Geometry>

#include "missions/cloud_file.h"
#include "sim/sensor.h"

namespace skycap::missions {

/// A moving sensor: as it was, or as its carrier believes.
struct SensorMotion {
  std::function<Eigen::Isometry3d(double time)> world_from_carrier;
  Eigen::Isometry3d carrier_from_sensor = Eigen::Isometry3d::Identity();
};

struct RawlogSetup {
  std::string sensor_name;
  sim::LidarConfig sensor;
  double start = 0.0;  ///< time of firing 0 [s]
  SensorMotion reported, true_one;
};

/// The module's one function. The caller owns what it returns.
using MakeRawlogFormat = CloudFormat*(const RawlogSetup& setup);
inline constexpr const char* make_rawlog_format_name = "skycap_make_rawlog_format";

}  // namespace skycap::missions
