/// ROS 2 robot in a simulated world. It publishes its pose and its measurements, and moves to the
/// requested goals. Its body frame is the optical frame of its camera. Optionally, the camera is on
/// a gimbal below the body. The body then never turns, and TF contains the gimbal rotation.
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

/// A published scan, with its pose as text and its points as floats.
struct SentScan {
  std::string pose;  ///< x y z qx qy qz qw, all digits
  std::vector<Eigen::Vector3f> points;
};

class Robot {
 public:
  /// `mission` is the text of a mission with a scene. `topics` is the prefix of all topic names.
  Robot(const std::string& mission, std::uint32_t domain, const std::string& topics,
        bool has_gimbal = false);

  /// Moves to the requested views, scans there, and sends valid and invalid messages until the
  /// survey requests no more views. Returns false after two minutes.
  bool survey();

  /// Stands still and publishes its pose until the status contains `text`. Returns false after 30
  /// s.
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
  /// Publishes the transforms of the body above the sensor and of the moving gimbal.
  void send_gimbal(const Eigen::Quaterniond& sensor) const;
  /// Turns while measuring, which makes the scan unusable.
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
