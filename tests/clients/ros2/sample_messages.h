/// Messages as robot drivers publish them. Tests modify them. Each sample owns the data that its
/// message points to.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "clients/ros2/messages.h"
#include "clients/ros2/pose_history.h"

namespace skycap::ros2 {

inline Header make_header(Stamp stamp, std::string& frame) {
  return {.stamp = {.sec = static_cast<std::int32_t>(stamp / 1'000'000'000),
                    .nanosec = static_cast<std::uint32_t>(stamp % 1'000'000'000)},
          .frame_id = frame.data()};
}

inline Stamp seconds(double time) { return static_cast<Stamp>(time * 1e9); }

/// Odometry of the robot's body.
struct SampleOdometry {
  SampleOdometry(Stamp stamp, const Eigen::Vector3d& position,
                 const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
    message.header = make_header(stamp, frame);
    message.child_frame_id = child_frame.data();
    message.pose.pose = {.position = {position.x(), position.y(), position.z()},
                         .orientation = {turn.x(), turn.y(), turn.z(), turn.w()}};
  }
  SampleOdometry(const SampleOdometry&) = delete;
  SampleOdometry& operator=(const SampleOdometry&) = delete;

  std::string frame = "odom", child_frame = "base_link";
  Odometry message{};
};

/// Transforms relative to parent frames, with the same timestamp.
struct SampleTransforms {
  struct Frame {
    std::string parent, name;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  };
  SampleTransforms(Stamp stamp, std::vector<Frame> given) : frames(std::move(given)) {
    for (Frame& frame : frames) {
      const Eigen::Vector3d& p = frame.position;
      const Eigen::Quaterniond& q = frame.turn;
      transforms.push_back({make_header(stamp, frame.parent),
                            frame.name.data(),
                            {{p.x(), p.y(), p.z()}, {q.x(), q.y(), q.z(), q.w()}}});
    }
    const auto count = static_cast<std::uint32_t>(transforms.size());
    message.transforms = {count, count, transforms.data(), false};
  }
  SampleTransforms(const SampleTransforms&) = delete;
  SampleTransforms& operator=(const SampleTransforms&) = delete;

  std::vector<Frame> frames;
  std::vector<TransformStamped> transforms;
  TFMessage message{};
};

/// Point cloud with one row: x y z as float32, followed by four unrelated bytes.
struct SampleCloud {
  SampleCloud(Stamp stamp, const std::vector<Eigen::Vector3f>& points) {
    constexpr std::uint32_t step = 16;
    data.resize(step * points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::memcpy(&data[step * i], points[i].data(), 3 * sizeof(float));
    }
    fields = {{names[0].data(), 0, 7, 1}, {names[1].data(), 4, 7, 1}, {names[2].data(), 8, 7, 1}};
    message.header = make_header(stamp, frame);
    message.height = 1;
    message.width = static_cast<std::uint32_t>(points.size());
    message.point_step = step;
    message.row_step = step * message.width;
    attach();
  }
  SampleCloud(const SampleCloud&) = delete;
  SampleCloud& operator=(const SampleCloud&) = delete;

  /// Must be called after changes to `fields` or `data`.
  void attach() {
    const auto count = static_cast<std::uint32_t>(fields.size());
    const auto bytes = static_cast<std::uint32_t>(data.size());
    message.fields = {count, count, fields.data(), false};
    message.data = {bytes, bytes, data.data(), false};
  }

  std::string frame = "camera_optical", names[3] = {"x", "y", "z"};
  std::vector<PointField> fields;
  std::vector<std::uint8_t> data;
  PointCloud2 message{};
};

/// Image with pixels of any number type.
struct SampleImage {
  template <typename Number>
  SampleImage(Stamp stamp, std::uint32_t width, const std::vector<Number>& pixels,
              std::string encoding_name)
      : encoding(std::move(encoding_name)), data(pixels.size() * sizeof(Number)) {
    std::memcpy(data.data(), pixels.data(), data.size());
    message.header = make_header(stamp, frame);
    message.width = width;
    message.height = static_cast<std::uint32_t>(pixels.size()) / width;
    message.encoding = encoding.data();
    message.step = width * static_cast<std::uint32_t>(sizeof(Number));
    const auto bytes = static_cast<std::uint32_t>(data.size());
    message.data = {bytes, bytes, data.data(), false};
  }
  SampleImage(const SampleImage&) = delete;
  SampleImage& operator=(const SampleImage&) = delete;

  std::string frame = "camera_optical", encoding;
  std::vector<std::uint8_t> data;
  Image message{};
};

/// Camera info for 4 x 2 pixels with fx = 2, fy = 4 and the principal point at (1.5, 0.5).
struct SampleInfo {
  explicit SampleInfo(std::vector<double> d = {}) : distortion(std::move(d)) {
    message.header = make_header(seconds(1.0), frame);
    message.width = 4;
    message.height = 2;
    message.distortion_model = model.data();
    const auto count = static_cast<std::uint32_t>(distortion.size());
    message.d = {count, count, distortion.data(), false};
    const double k[9] = {2, 0, 1.5, 0, 4, 0.5, 0, 0, 1};
    std::memcpy(message.k, k, sizeof k);
  }
  SampleInfo(const SampleInfo&) = delete;
  SampleInfo& operator=(const SampleInfo&) = delete;

  std::string frame = "camera_optical", model = "plumb_bob";
  std::vector<double> distortion;
  CameraInfo message{};
};

}  // namespace skycap::ros2
