/// A robot of ROS 2 in a simulated world: it publishes where it is and what it measures, and goes
/// where it is told. Its body's frame is its camera's optical frame; or the camera is on a gimbal
/// under the body, which never turns itself, and TF says how that does.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "clients/ros2/dds_ports.h"
#include "clients/ros2/pose_history.h"
#include "missions/config/mission_setup.h"
#include "missions/evaluation/survey_scene.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::ros2 {

/// What was published: the same numbers as text and as floats.
struct SentScan {
  std::string pose;  ///< x y z qx qy qz qw, all digits
  std::vector<Eigen::Vector3f> points;
};

class Robot {
 public:
  /// The text of a mission with a scene; `topics` begins the names of all topics.
  Robot(const std::string& mission, std::uint32_t domain, const std::string& topics,
        bool has_gimbal = false);

  /// Goes to the views it is told, scans there, and sends good messages among bad ones, until the
  /// survey does not want a view any more. False if that takes more than two minutes.
  bool survey();

  /// Stands still and says so until the status has this text; false after half a minute.
  bool wait_for_status(const std::string& text);

  void command(std::string text) const { commands_.write({text.data()}); }

  const std::vector<SentScan>& scans() const { return scans_; }
  std::size_t longest_path() const { return longest_path_; }

 private:
  struct Measured {
    PoseMessage pose;
    SentScan scan;
  };

  void listen();
  Measured measure(const PoseMessage& sensor, std::size_t number) const;
  void stay_at(const PoseMessage& pose, int steps);
  /// The body above the sensor, and the gimbal on its way there.
  void send_gimbal(const Eigen::Quaterniond& sensor) const;
  /// Turns while it measures: a scan that nobody may use.
  void turn_to(const PoseMessage& pose);
  void send_nonsense(const Measured& measured);
  void send_odometry(Stamp stamp, const PoseMessage& pose) const;
  void send_cloud(Stamp stamp, const std::vector<Eigen::Vector3f>& points) const;

  missions::config::MissionSetup setup_;
  missions::evaluation::SurveyScene scene_;
  sim::SurveySensor sensor_;
  Participant participant_;
  bool has_gimbal_;
  Writer<Odometry> odometry_;
  Writer<TFMessage> transforms_, fixed_;
  Writer<PointCloud2> clouds_;
  Writer<String> commands_;
  Reader<PoseStamped> views_;
  Reader<Path> paths_;
  Reader<String> statuses_;
  nlohmann::json status_;
  PoseMessage here_{{0, 0, 0}, {0, 0, 0, 1}}, target_{};
  std::size_t longest_path_ = 0;
  Stamp clock_ = 1'000'000'000'000;
  std::vector<SentScan> scans_;
};

}  // namespace skycap::ros2
