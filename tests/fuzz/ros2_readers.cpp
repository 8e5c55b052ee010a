// ROS 2 messages as received from DDS. Counts and lengths are those of the sender and may be wrong.
// The input consists of some consecutive fields and the data.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <variant>
#include <vector>

#include "clients/ros2/frames.h"
#include "clients/ros2/sensor_scan.h"
#include "clients/ros2/throttled_warnings.h"
#include "clients/ros2/transforms.h"
#include "geometry/error.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/trial_run.h"

namespace skycap::fuzz {
namespace {

/// Extracts values from the beginning of the input. Returns zeros after its end.
class Front {
 public:
  Front(const std::uint8_t* bytes, std::size_t size) : bytes_(bytes, bytes + size) {}

  template <typename Value>
  Value take() {
    Value value{};
    const std::size_t count = std::min(sizeof(Value), bytes_.size() - at_);
    if (count > 0) std::memcpy(&value, bytes_.data() + at_, count);
    at_ += count;
    return value;
  }

  /// Returns one of several strings.
  template <std::size_t count>
  const char* choice(const std::array<const char*, count>& texts) {
    return texts[take<std::uint8_t>() % count];
  }

  /// Returns the rest in its own allocation, so that the address sanitiser detects reads beyond its
  /// end.
  std::vector<std::uint8_t> rest() const {
    return {bytes_.begin() + static_cast<std::ptrdiff_t>(at_), bytes_.end()};
  }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

bool are_finite(const auto& numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

int run_cloud(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::array<const char*, 5> names{"x", "y", "z", "intensity", nullptr};
  Front front(bytes, size);
  ros2::PointCloud2 cloud{};
  cloud.height = front.take<std::uint32_t>();
  cloud.width = front.take<std::uint32_t>();
  cloud.point_step = front.take<std::uint32_t>();
  cloud.row_step = front.take<std::uint32_t>();
  cloud.is_bigendian = front.take<std::uint8_t>() % 2 == 1;
  const auto axes = front.take<std::uint8_t>() % 2 == 1 ? ros2::Axes::flu : ros2::Axes::optical;
  std::vector<ros2::PointField> fields(front.take<std::uint8_t>() % 6);
  for (ros2::PointField& field : fields) {
    field.name = const_cast<char*>(front.choice(names));
    field.offset = front.take<std::uint32_t>();
    field.datatype = front.take<std::uint8_t>();
    field.count = front.take<std::uint32_t>();
  }
  cloud.fields._buffer = fields.data();
  cloud.fields._length = static_cast<std::uint32_t>(fields.size());
  std::vector<std::uint8_t> data = front.rest();
  cloud.data._buffer = data.data();
  cloud.data._length = static_cast<std::uint32_t>(data.size());
  return run_reader("", [&] {
    const std::vector<float> xyz = ros2::make_scan(cloud, axes).xyz;
    require(xyz.size() % 3 == 0 && 4 * xyz.size() <= data.size(), "points that were not sent");
    require(are_finite(xyz), "a point that is none");
  });
}

ros2::CameraInfo camera_info(Front& front, std::vector<double>& distortion) {
  constexpr std::array<const char*, 4> models{"plumb_bob", "rational_polynomial", "fisheye",
                                              nullptr};
  ros2::CameraInfo info{};
  info.width = front.take<std::uint32_t>();
  info.height = front.take<std::uint32_t>();
  info.binning_x = front.take<std::uint8_t>();
  info.roi.width = front.take<std::uint8_t>();
  info.distortion_model = const_cast<char*>(front.choice(models));
  for (const int i : {0, 2, 4, 5}) info.k[i] = front.take<double>();
  for (const int i : {0, 2, 5, 6}) info.p[i] = front.take<double>();
  distortion.resize(front.take<std::uint8_t>() % 9);
  for (double& number : distortion) number = front.take<double>();
  info.d._buffer = distortion.data();
  info.d._length = static_cast<std::uint32_t>(distortion.size());
  return info;
}

void require_sane(const ros2::DepthScan& scan) {
  require(scan.width > 0 && scan.height > 0 &&
              scan.depth.size() ==
                  static_cast<std::size_t>(scan.width) * static_cast<std::size_t>(scan.height),
          "an image of other sides");
}

int run_image(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::array<const char*, 5> encodings{"16UC1", "mono16", "32FC1", "rgb8", nullptr};
  Front front(bytes, size);
  std::vector<double> distortion;
  const bool is_rectified = front.take<std::uint8_t>() % 2 == 1;
  const ros2::CameraInfo info = camera_info(front, distortion);
  ros2::Image image{};
  image.height = front.take<std::uint32_t>();
  image.width = front.take<std::uint32_t>();
  image.step = front.take<std::uint32_t>();
  image.is_bigendian = front.take<std::uint8_t>();
  image.encoding = const_cast<char*>(front.choice(encodings));
  std::vector<std::uint8_t> data = front.rest();
  image.data._buffer = data.data();
  image.data._length = static_cast<std::uint32_t>(data.size());
  return run_reader("", [&] {
    const ros2::CameraIntrinsics intrinsics = ros2::to_intrinsics(info, is_rectified);
    require(intrinsics.intrinsics.size() == 4 || intrinsics.intrinsics.size() == 9,
            "a lens of other numbers");
    require(are_finite(intrinsics.intrinsics) && intrinsics.intrinsics[0] > 0.0 &&
                intrinsics.intrinsics[1] > 0.0,
            "no lens");
    const ros2::SensorScan scan = ros2::make_scan(image, intrinsics);
    if (const auto* depth = std::get_if<ros2::DepthScan>(&scan)) require_sane(*depth);
  });
}

int run_odometry(const std::uint8_t* bytes, std::size_t size) {
  Front front(bytes, size);
  ros2::Odometry odometry{};
  auto& [position, turn] = odometry.pose.pose;
  for (double* number :
       {&position.x, &position.y, &position.z, &turn.x, &turn.y, &turn.z, &turn.w}) {
    *number = front.take<double>();
  }
  for (double& number : odometry.pose.covariance) number = front.take<double>();
  return run_reader("", [&] {
    const ros2::BodyPose body = ros2::body_pose(odometry);
    require(body.position.allFinite(), "a place that is none");
    require(std::abs(body.turn.norm() - 1.0) < 1e-9, "a pose that stretches");
    const ros2::Mount mount(Eigen::Isometry3d::Identity(), ros2::Axes::flu);
    if (const auto covariance = mount.covariance_at_sensor(body)) {
      require(covariance->isApprox(covariance->transpose()), "a covariance that is not symmetric");
    }
  });
}

/// Adds transforms between a few frames, so that they connect, and queries transforms between them.
int run_transforms(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::array<const char*, 7> names{"map",    "odom", "base_link", "gimbal",
                                             "camera", "",     nullptr};
  Front front(bytes, size);
  const std::size_t count = front.take<std::uint8_t>();
  return run_reader("", [&] {
    ros2::Transforms tree(ros2::HistoryConfig{});
    for (std::size_t i = 0; i < count; ++i) {
      ros2::TransformStamped transform{};
      transform.header.frame_id = const_cast<char*>(front.choice(names));
      transform.child_frame_id = const_cast<char*>(front.choice(names));
      transform.header.stamp = {front.take<std::int8_t>(), front.take<std::uint32_t>()};
      auto& [position, turn] = transform.transform;
      for (double* number : {&position.x, &position.y, &position.z, &turn.x, &turn.y, &turn.z}) {
        *number = front.take<std::int8_t>() / 64.0;
      }
      turn.w = front.take<double>();
      const bool is_static = front.take<std::uint8_t>() % 2 == 1;
      try {
        tree.add(transform, is_static);
      } catch (const Error&) {  // ignored, as in the bridge
      }
      const std::string target = ros2::printable_text(front.choice(names));
      const std::string source = ros2::printable_text(front.choice(names));
      const ros2::PoseMatch match = tree.at(target, source, front.take<std::int32_t>() * 1000LL);
      if (match.state != ros2::PoseMatch::State::known) continue;
      require(std::abs(match.pose.turn.norm() - 1.0) < 1e-9, "a chain that stretches");
    }
  });
}

constexpr Reader readers[] = {{"ros2_cloud", run_cloud},
                              {"ros2_image", run_image},
                              {"ros2_odometry", run_odometry},
                              {"ros2_transforms", run_transforms}};

}  // namespace

std::span<const Reader> ros2_readers() { return readers; }

}  // namespace skycap::fuzz
