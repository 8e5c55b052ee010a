/// The program skycap_ros2: a bridge with its topics and its survey.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "clients/ros2/bridge.h"

namespace skycap::ros2 {

struct NodeConfig {
  std::string address;       ///< what `skycap serve` prints
  std::uint32_t domain = 0;  ///< ROS_DOMAIN_ID
  std::string odometry = "/odom";
  std::string cloud = "/points";  ///< of clouds, unless there is an `image`
  std::string image;              ///< of depth images
  std::string camera_info;        ///< its CameraInfo; empty: beside `image`, as ROS has it
  std::string transforms = "/tf", static_transforms = "/tf_static";  ///< if the bridge uses some
  std::string prefix = "/skycap";                                    ///< of what is published
  BridgeConfig bridge;
};

/// Until the survey is finished or `stop` is set. Warnings go to stderr. Throws Error for topics
/// and DDS, and std::runtime_error if the survey cannot be talked to any more; its journal has all
/// that was taken in.
void run_node(const NodeConfig& config, const std::atomic<bool>& stop);

/// The topic of an image's CameraInfo: the same with camera_info in place of the last name.
std::string camera_info_topic(const std::string& image);

}  // namespace skycap::ros2
