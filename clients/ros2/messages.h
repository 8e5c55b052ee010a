/// ROS 2 message types with their ROS names, and their DDS descriptors.
#pragma once

#include "ros2_messages.h"

namespace skycap::ros2 {

using Header = std_msgs_msg_dds__Header_;
using String = std_msgs_msg_dds__String_;
using PoseMessage = geometry_msgs_msg_dds__Pose_;
using QuaternionMessage = geometry_msgs_msg_dds__Quaternion_;
using PoseStamped = geometry_msgs_msg_dds__PoseStamped_;
using TransformMessage = geometry_msgs_msg_dds__Transform_;
using TransformStamped = geometry_msgs_msg_dds__TransformStamped_;
using TFMessage = tf2_msgs_msg_dds__TFMessage_;
using Odometry = nav_msgs_msg_dds__Odometry_;
using Path = nav_msgs_msg_dds__Path_;
using PointField = sensor_msgs_msg_dds__PointField_;
using PointCloud2 = sensor_msgs_msg_dds__PointCloud2_;
using Image = sensor_msgs_msg_dds__Image_;
using CameraInfo = sensor_msgs_msg_dds__CameraInfo_;

template <typename Message>
const dds_topic_descriptor_t& descriptor();
template <>
inline const dds_topic_descriptor_t& descriptor<String>() {
  return std_msgs_msg_dds__String__desc;
}
template <>
inline const dds_topic_descriptor_t& descriptor<PoseStamped>() {
  return geometry_msgs_msg_dds__PoseStamped__desc;
}
template <>
inline const dds_topic_descriptor_t& descriptor<Odometry>() {
  return nav_msgs_msg_dds__Odometry__desc;
}
template <>
inline const dds_topic_descriptor_t& descriptor<TFMessage>() {
  return tf2_msgs_msg_dds__TFMessage__desc;
}
template <>
inline const dds_topic_descriptor_t& descriptor<Path>() {
  return nav_msgs_msg_dds__Path__desc;
}
template <>
inline const dds_topic_descriptor_t& descriptor<PointCloud2>() {
  return sensor_msgs_msg_dds__PointCloud2__desc;
}
template <>
inline const dds_topic_descriptor_t& descriptor<Image>() {
  return sensor_msgs_msg_dds__Image__desc;
}
template <>
inline const dds_topic_descriptor_t& descriptor<CameraInfo>() {
  return sensor_msgs_msg_dds__CameraInfo__desc;
}

}  // namespace skycap::ros2
