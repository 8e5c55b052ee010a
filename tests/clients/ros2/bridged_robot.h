/// Fixture: a bridge between a scripted robot and a scripted survey.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "clients/ros2/bridge.h"
#include "tests/clients/ros2/sample_messages.h"

namespace skycap::ros2 {

using Eigen::Vector3d;

/// Survey status that requests a view at (5, 0, 0), looking along the world's z axis, so that the
/// robot does not have to turn.
inline constexpr const char* first_view =
    R"({"id": 3, "state": "view", "scans": 2, "points": 9, "rejected": 0,
        "view": {"position": [5, 0, 0], "direction": [0, 0, 1], "quaternion_xyzw": [0, 0, 0, 1]},
        "path": [[0, 0, 0], [5, 0, 0]], "clearance_m": 2})";

class Ros2Bridge : public testing::Test {
 protected:
  void begin(BridgeConfig config = {}) {
    bridge_ = std::make_unique<Bridge>(
        std::move(config),
        SurveyPort{.next = [this] { return answer_; },
                   .finish = [this] { return ++finished_, std::string(); },
                   .add =
                       [this](const SensorScan& scan, const skycap_live::Pose& pose,
                              const skycap_live::PoseError& error, skycap_live::From from) {
                         if (!rejection_.empty()) throw skycap_live::Rejected(rejection_);
                         scans_.push_back(scan);
                         poses_.push_back(pose);
                         errors_.push_back(error);
                         origins_.push_back(from);
                         return answer_;
                       },
                   .reject =
                       [this](std::size_t id, const std::string& reason) {
                         rejected_.push_back(std::to_string(id) + " " + reason);
                         return answer_;
                       }},
        BridgeCallbacks{.goal = [this](const Goal& goal) { goals_.push_back(goal); },
                        .status = [this](const std::string& text) { status_ = text; },
                        .warning = [this](const std::string& line) { warnings_.push_back(line); }});
    bridge_->begin();
  }

  void odometry(double time, const Vector3d& position) {
    const SampleOdometry sample(seconds(time), position);
    bridge_->receive(sample.message, now_);
  }
  void cloud(double time) {
    const SampleCloud sample(seconds(time), {{1, 2, 3}});
    bridge_->receive(sample.message, now_);
  }
  void command(std::string text) { bridge_->receive(String{text.data()}, now_); }
  void proceed(double later = 0.0) {
    now_ += later;
    bridge_->proceed(now_);
  }
  void transforms(double time, std::vector<SampleTransforms::Frame> frames,
                  bool is_static = false) {
    const SampleTransforms sample(seconds(time), std::move(frames));
    bridge_->receive(sample.message, is_static, now_);
  }
  /// Begins with TF only, in which the camera is 0.5 m above the body.
  void begin_with_transforms() {
    begin({.uses_transforms = true, .world = "map"});
    transforms(0.0, {{"base_link", "camera_optical", {0, 0, 0.5}}}, true);
  }
  /// Publishes poses from 9 s to 11 s in steps of 0.05 s. `position` gives the body position,
  /// through two frames.
  void localised(const std::function<Vector3d(double)>& position) {
    for (int step = 0; step <= 40; ++step) {
      const double time = 9.0 + 0.05 * step;
      transforms(time, {{"map", "odom", {1, 0, 0}}, {"odom", "base_link", position(time)}});
    }
  }

  /// Publishes odometry at the view from 9 s on, in steps of 0.05 s.
  void arrive() {
    for (int step = 0; step <= 40; ++step) odometry(9.0 + 0.05 * step, {5, 0, 0});
  }

  double now_ = 100.0;
  std::string answer_ = first_view, rejection_, status_;
  int finished_ = 0;
  std::vector<SensorScan> scans_;
  std::vector<skycap_live::Pose> poses_;
  std::vector<skycap_live::PoseError> errors_;
  std::vector<skycap_live::From> origins_;
  std::vector<std::string> warnings_, rejected_;
  std::vector<Goal> goals_;
  std::unique_ptr<Bridge> bridge_;
};

}  // namespace skycap::ros2
