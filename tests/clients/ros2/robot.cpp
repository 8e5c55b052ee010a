#include "tests/clients/ros2/robot.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <thread>

#include "geometry/pose/pose.h"
#include "missions/config/resolve.h"
#include "tests/clients/ros2/sample_messages.h"

namespace skycap::ros2 {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using namespace std::chrono_literals;

/// The camera looks along the gimbal's x axis, with its right along -y.
const Quaterniond optical_on_gimbal(0.5, -0.5, 0.5, -0.5);
const Vector3d gimbal_on_body(0.1, 0.0, -0.3);

Quaterniond to_quaternion(const PoseMessage& pose) {
  const auto& [x, y, z, w] = pose.orientation;
  return Quaterniond(w, x, y, z).normalized();
}

Isometry3d isometry(const PoseMessage& pose) {
  const auto& [position, turn] = pose;
  Isometry3d world_from_sensor = Isometry3d::Identity();
  world_from_sensor.translation() = Vector3d(position.x, position.y, position.z);
  world_from_sensor.linear() =
      Quaterniond(turn.w, turn.x, turn.y, turn.z).normalized().toRotationMatrix();
  return world_from_sensor;
}

constexpr Stamp step = 20'000'000;

std::string to_string(const PoseMessage& pose) {
  const auto& [p, q] = pose;
  char text[256];
  std::snprintf(text, sizeof text, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g", p.x, p.y, p.z, q.x,
                q.y, q.z, q.w);
  return text;
}

}  // namespace

Robot::Robot(const std::string& mission, std::uint32_t domain, const std::string& topics,
             bool has_gimbal)
    : setup_(missions::config::parse_mission(mission, "m.yaml")),
      scene_(setup_.simulation, "", setup_.run.threads),
      sensor_(setup_.sensor(), setup_.run.seed),
      participant_(domain),
      has_gimbal_(has_gimbal),
      odometry_(participant_, topics + "/odom", Writing::sensor),
      transforms_(participant_, topics + "/tf", Writing::sensor),
      fixed_(participant_, topics + "/tf_static", Writing::latched),
      clouds_(participant_, topics + "/points", Writing::sensor),
      commands_(participant_, topics + "/skycap/command", Writing::command),
      views_(participant_, topics + "/skycap/next_sensor_pose", ReaderQos::latched, 1),
      paths_(participant_, topics + "/skycap/path", ReaderQos::latched, 10),
      statuses_(participant_, topics + "/skycap/status", ReaderQos::latched, 1) {
  if (!has_gimbal_) return;
  const SampleTransforms camera(
      1, {{"gimbal", "camera_optical", Vector3d::Zero(), optical_on_gimbal}});
  fixed_.write(camera.message);
}

void Robot::listen() {
  views_.take([this](const PoseStamped& message) { target_ = message.pose; });
  paths_.take([this](const Path& message) {
    longest_path_ = std::max<std::size_t>(longest_path_, message.poses._length);
  });
  statuses_.take([this](const String& message) { status_ = nlohmann::json::parse(message.data); });
}

Robot::Measured Robot::measure(const PoseMessage& sensor, std::size_t number) const {
  const Isometry3d world_from_sensor = isometry(sensor);
  const geometry::Scan scan =
      sensor_.scan(scene_.scene(), geometry::to_view(world_from_sensor), number, 1);
  Measured measured{sensor, {to_string(sensor), {}}};
  for (const Eigen::Vector3f& point : scan.points) {
    measured.scan.points.push_back(
        (world_from_sensor.inverse() * point.cast<double>()).cast<float>());
  }
  return measured;
}

void Robot::send_odometry(Stamp stamp, const PoseMessage& pose) const {
  SampleOdometry sample(stamp, Vector3d::Zero());
  sample.message.pose.pose = pose;
  if (has_gimbal_) {
    auto& [position, turn] = sample.message.pose.pose;
    turn = {0, 0, 0, 1};
    position = {position.x - gimbal_on_body.x(), position.y - gimbal_on_body.y(),
                position.z - gimbal_on_body.z()};
  }
  odometry_.write(sample.message);
}

void Robot::send_gimbal(const Quaterniond& sensor) const {
  if (!has_gimbal_) return;
  constexpr Stamp later = 7'000'000;  // delay after odometry
  const SampleTransforms gimbal(clock_ + later, {{"base_link", "gimbal", gimbal_on_body,
                                                  sensor * optical_on_gimbal.conjugate()}});
  transforms_.write(gimbal.message);
}

void Robot::turn_to(const PoseMessage& pose) {
  if (!has_gimbal_) return;
  const Quaterniond from = to_quaternion(here_), to = to_quaternion(pose);
  constexpr int steps = 20;
  for (int i = 0; i < steps; ++i) {
    send_odometry(clock_ += step, pose);
    send_gimbal(from.slerp(i / static_cast<double>(steps), to));
    if (i % 5 == 0) send_cloud(clock_ - step, {{0.0F, 0.0F, 1.0F}, {0.1F, 0.0F, 1.0F}});
    std::this_thread::sleep_for(2ms);
  }
}

void Robot::send_cloud(Stamp stamp, const std::vector<Eigen::Vector3f>& points) const {
  const SampleCloud sample(stamp, points);
  clouds_.write(sample.message);
}

void Robot::stay_at(const PoseMessage& pose, int steps) {
  here_ = pose;
  for (int i = 0; i < steps; ++i) {
    send_odometry(clock_ += step, pose);
    send_gimbal(to_quaternion(pose));
    std::this_thread::sleep_for(2ms);
  }
}

/// Sends the scan with a wrong pose, twice, and in halves, and sends invalid odometry.
void Robot::send_nonsense(const Measured& measured) {
  const auto& points = measured.scan.points;
  PoseMessage wrong = measured.pose;
  wrong.position.x += 3.0;
  send_odometry(clock_, wrong);                      // a different pose with the same timestamp
  send_odometry(clock_ + 3'600'000'000'000, wrong);  // from the future
  wrong.orientation = {0, 0, 0, 0};
  send_odometry(clock_ - 10'000'000, wrong);
  wrong.position.y = std::numeric_limits<double>::quiet_NaN();
  send_odometry(clock_ + 10'000'000, wrong);
  send_cloud(0, points);
  SampleCloud half(clock_, points);
  half.message.data._length /= 2;
  clouds_.write(half.message);
  half.message.data._length *= 2;
  half.message.fields._length = 2;
  clouds_.write(half.message);
  std::this_thread::sleep_for(50ms);
}

bool Robot::wait_for_status(const std::string& text) {
  for (int i = 0; i < 300; ++i) {
    stay_at(here_, 5);
    listen();
    if (!status_.is_null() && status_.dump().find(text) != std::string::npos) return true;
    std::this_thread::sleep_for(90ms);
  }
  return false;
}

bool Robot::survey() {
  const auto end = std::chrono::steady_clock::now() + 120s;
  if (!wait_for_status("\"state\":\"view\"")) return false;
  while (std::chrono::steady_clock::now() < end) {
    stay_at(here_, 1);
    std::this_thread::sleep_for(50ms);
    listen();
    if (status_.at("taken") != scans_.size()) continue;
    if (status_.at("state") != "view") return true;
    const auto status_position = status_.at("view").at("position").get<std::vector<double>>();
    if (std::abs(status_position[0] - target_.position.x) > 1e-9)
      continue;  // its message has not arrived yet
    const Measured measured = measure(target_, scans_.size());
    turn_to(target_);
    stay_at(target_, 20);
    send_nonsense(measured);
    const std::size_t taken = scans_.size();
    for (int attempt = 0; attempt < 20 && status_.at("taken") == taken; ++attempt) {
      send_cloud(clock_, measured.scan.points);
      std::this_thread::sleep_for(20ms);
      send_cloud(clock_, measured.scan.points);  // duplicate
      for (int i = 0; i < 20 && status_.at("taken") == taken; ++i) {
        std::this_thread::sleep_for(100ms);
        listen();
      }
      stay_at(target_, 1);
    }
    scans_.push_back(measured.scan);
  }
  return false;
}

}  // namespace skycap::ros2
