/// Program skycap_ros2: a bridge with its topics and its survey.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "clients/ros2/bridge.h"

namespace skycap::ros2 {

struct NodeConfig {
  std::string address;       ///< Address printed by `skycap serve`.
  std::uint32_t domain = 0;  ///< ROS_DOMAIN_ID.
  std::string odometry = "/odom";
  std::string cloud = "/points";  ///< Topic of point clouds, unless `image` is set.
  std::string image;              ///< Topic of depth images.
  /// Topic of the CameraInfo. Empty: next to `image`, as is usual in ROS.
  std::string camera_info;
  /// Topics of transforms, if the bridge uses them.
  std::string transforms = "/tf", static_transforms = "/tf_static";
  std::string prefix = "/skycap";  ///< Prefix of published topics.
  BridgeConfig bridge;
};

/// Runs until the survey is finished or `stop` is set. Warnings are written to stderr. Throws Error
/// for problems with topics and DDS, and std::runtime_error if the connection to the survey is
/// lost. The journal of the survey then contains all accepted scans.
void run_node(const NodeConfig& config, const std::atomic<bool>& stop);

/// Returns the CameraInfo topic of an image topic: its last component is replaced by camera_info.
std::string camera_info_topic(const std::string& image);

}  // namespace skycap::ros2
