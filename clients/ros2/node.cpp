#include "clients/ros2/node.h"

#include <chrono>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <utility>

#include "clients/ros2/dds_ports.h"
#include "clients/skycap_live.h"

namespace skycap::ros2 {
namespace {

using Eigen::Isometry3d;

/// Returns the time of a monotonic clock [s].
double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

SurveyPort make_survey_port(skycap_live::Survey& survey) {
  return {.next = [&] { return survey.next(); },
          .finish = [&] { return survey.finish(); },
          .add =
              [&](const SensorScan& scan, const skycap_live::Pose& pose,
                  const skycap_live::PoseError& error, skycap_live::From from) {
                if (const auto* cloud = std::get_if<CloudScan>(&scan)) {
                  return survey.add_cloud(cloud->xyz, pose, error, from);
                }
                const auto& image = std::get<DepthScan>(scan);
                return survey.add_depth(image.depth, image.width, image.height, image.unit, pose,
                                        error, image.intrinsics, from);
              },
          .reject = [&](std::size_t id,
                        const std::string& reason) { return survey.reject(id, reason); }};
}

/// Message header with storage for its frame name.
struct Heading {
  explicit Heading(const Goal& goal) : frame(goal.frame) {
    header.stamp.sec = static_cast<std::int32_t>(goal.stamp / 1'000'000'000);
    header.stamp.nanosec = static_cast<std::uint32_t>(goal.stamp % 1'000'000'000);
    header.frame_id = frame.data();
  }
  Heading(const Heading&) = delete;
  Heading& operator=(const Heading&) = delete;

  std::string frame;
  Header header{};
};

PoseMessage make_message(const Isometry3d& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  return {.position = {pose.translation().x(), pose.translation().y(), pose.translation().z()},
          .orientation = {turn.x(), turn.y(), turn.z(), turn.w()}};
}

/// Returns the body poses along the path, with the orientation at its end.
std::vector<PoseStamped> body_path(const Goal& goal, const Header& header) {
  std::vector<PoseStamped> poses;
  for (const Eigen::Vector3d& position : goal.path) {
    Isometry3d pose = goal.view.value_or(Isometry3d::Identity());
    pose.translation() = position;
    poses.push_back({header, make_message(goal.mount->world_from_body(pose))});
  }
  return poses;
}

/// Published topics.
class Outputs {
 public:
  Outputs(const Participant& participant, const std::string& prefix)
      : next_view_(participant, prefix + "/next_view", Writing::latched),
        next_sensor_pose_(participant, prefix + "/next_sensor_pose", Writing::latched),
        path_(participant, prefix + "/path", Writing::latched),
        status_(participant, prefix + "/status", Writing::latched) {}

  ~Outputs() { status_.flush(); }

  /// Publishes the path before the view, so that a subscriber of the view can depart at once.
  /// Without a mount, the body pose for a sensor pose is unknown.
  void goal(const Goal& goal) const {
    const Heading heading(goal);
    if (goal.mount) {
      std::vector<PoseStamped> poses = body_path(goal, heading.header);
      const auto count = static_cast<std::uint32_t>(poses.size());
      path_.write({heading.header, {count, count, poses.data(), false}});
    }
    if (!goal.view) return;
    next_sensor_pose_.write({heading.header, make_message(*goal.view)});
    if (!goal.mount) return;
    next_view_.write({heading.header, make_message(goal.mount->world_from_body(*goal.view))});
  }

  void status(std::string text) const { status_.write({text.data()}); }

 private:
  Writer<PoseStamped> next_view_, next_sensor_pose_;
  Writer<Path> path_;
  Writer<String> status_;
};

/// Subscribed topics.
class Inputs {
 public:
  Inputs(const Participant& participant, const NodeConfig& config)
      : waits_(participant),
        commands_(participant, config.prefix + "/command", ReaderQos::command, 10) {
    constexpr int few = 2;  // During planning, old scans become useless.
    if (config.image.empty()) {
      clouds_ =
          std::make_unique<Reader<PointCloud2>>(participant, config.cloud, ReaderQos::sensor, few);
      waits_.add(*clouds_);
    } else {
      images_ = std::make_unique<Reader<Image>>(participant, config.image, ReaderQos::sensor, few);
      infos_ = std::make_unique<Reader<CameraInfo>>(
          participant,
          config.camera_info.empty() ? camera_info_topic(config.image) : config.camera_info,
          ReaderQos::sensor, few);
      waits_.add(*images_);
      waits_.add(*infos_);
    }
    add_poses(participant, config);
    waits_.add(commands_);
  }

  /// Waits briefly for messages and forwards them, poses before scans.
  void forward_to(Bridge& bridge) const {
    constexpr double moment = 0.05;
    waits_.wait(moment);
    const auto forward = [&](const auto& message) { bridge.receive(message, now()); };
    if (fixed_) fixed_->take([&](const TFMessage& m) { bridge.receive(m, true, now()); });
    if (moving_) moving_->take([&](const TFMessage& m) { bridge.receive(m, false, now()); });
    if (odometry_) odometry_->take(forward);
    commands_.take(forward);
    if (infos_) infos_->take(forward);
    if (clouds_) clouds_->take(forward);
    if (images_) images_->take(forward);
  }

 private:
  /// Subscribes to the topics of body and sensor poses.
  void add_poses(const Participant& participant, const NodeConfig& config) {
    constexpr int many = 2000;  // Capacity for the poses that arrive during planning.
    const bool asks_odometry = config.bridge.world.empty();
    if (asks_odometry) {
      odometry_ =
          std::make_unique<Reader<Odometry>>(participant, config.odometry, ReaderQos::sensor, many);
      waits_.add(*odometry_);
    }
    if (asks_odometry && !config.bridge.uses_transforms) return;
    moving_ = std::make_unique<Reader<TFMessage>>(participant, config.transforms, ReaderQos::sensor,
                                                  many);
    fixed_ = std::make_unique<Reader<TFMessage>>(participant, config.static_transforms,
                                                 ReaderQos::latched, many);
    waits_.add(*moving_);
    waits_.add(*fixed_);
  }

  WaitSet waits_;
  std::unique_ptr<Reader<Odometry>> odometry_;
  std::unique_ptr<Reader<TFMessage>> moving_, fixed_;
  Reader<String> commands_;
  std::unique_ptr<Reader<PointCloud2>> clouds_;
  std::unique_ptr<Reader<Image>> images_;
  std::unique_ptr<Reader<CameraInfo>> infos_;
};

}  // namespace

std::string camera_info_topic(const std::string& image) {
  return image.substr(0, image.rfind('/')) + "/camera_info";
}

void run_node(const NodeConfig& config, const std::atomic<bool>& stop) {
  const Participant participant(config.domain);
  const Outputs outputs(participant, config.prefix);
  const Inputs inputs(participant, config);
  skycap_live::Survey survey(config.address);
  Bridge bridge(config.bridge, make_survey_port(survey),
                {.goal = [&](const Goal& goal) { outputs.goal(goal); },
                 .status = [&](const std::string& text) { outputs.status(text); },
                 .warning =
                     [](const std::string& line) {
                       std::cerr << "skycap_ros2: warning: " + line + "\n" << std::flush;
                     }});
  try {
    bridge.begin();
    while (!stop && !bridge.is_finished()) {
      inputs.forward_to(bridge);
      bridge.proceed(now());
    }
    if (stop) bridge.set_status("stopped");
  } catch (const std::exception&) {
    bridge.set_status("lost the connection to the survey server");
    throw;
  }
}

}  // namespace skycap::ros2
