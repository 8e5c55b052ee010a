// Program skycap_ros2: a live survey with a ROS 2 robot over DDS (docs/reference/ros2-topics.md).

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <initializer_list>
#include <iostream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "clients/ros2/node.h"
#include "geometry/angle.h"
#include "geometry/error.h"

namespace {

using skycap::ros2::Axes;
using skycap::ros2::NodeConfig;
using skycap::ros2::Taking;

std::atomic<bool> is_stopped = false;

/// Stops after the current message; a second signal terminates at once.
void end_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { is_stopped = true; };
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

struct Options {
  NodeConfig node;
  std::string sensor;
  Axes axes = Axes::optical;
  double direction_tolerance_deg = 5.0;
  bool ignores_covariance = false;
};

void add_topics(CLI::App& app, Options& options) {
  NodeConfig& node = options.node;
  app.add_option("ADDRESS", node.address,
                 "Address of the server, as printed by skycap serve: unix:PATH or tcp:...")
      ->required();
  app.add_option("--domain", node.domain, "DDS domain (ROS_DOMAIN_ID)")
      ->envname("ROS_DOMAIN_ID")
      ->check(CLI::Range(0, 232));
  app.add_option("--odometry", node.odometry, "nav_msgs/Odometry")->capture_default_str();
  app.add_option("--cloud", node.cloud, "sensor_msgs/PointCloud2")->capture_default_str();
  app.add_option("--image", node.image,
                 "Topic of depth images (sensor_msgs/Image), instead of point clouds");
  app.add_option(
      "--camera-info", node.camera_info,
      "Topic of the image's CameraInfo (default: camera_info in the namespace of the image)");
  app.add_option("--fixed-frame", node.bridge.world,
                 "Fixed TF frame, for example map. Poses are read from TF instead of odometry");
  app.add_option("--base-frame", node.bridge.body, "Base frame of the robot, with --fixed-frame")
      ->capture_default_str();
  app.add_option("--tf", node.transforms, "tf2_msgs/TFMessage")->capture_default_str();
  app.add_option("--tf-static", node.static_transforms,
                 "Topic of static transforms (tf2_msgs/TFMessage)")
      ->capture_default_str();
  app.add_option("--prefix", node.prefix, "Prefix of published topics")->capture_default_str();
}

void add_rules(CLI::App& app, Options& options) {
  auto& bridge = options.node.bridge;
  app.add_option("--sensor-pose", options.sensor,
                 "Pose of the sensor in the base frame: x y z qx qy qz qw (default: from TF)");
  app.add_option("--axes", options.axes,
                 "Axes of the points' frame (REP 103): optical or flu (default: optical)")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, Axes>{{"optical", Axes::optical}, {"flu", Axes::flu}}))
      ->option_text("optical|flu");
  app.add_flag("--rectified", bridge.is_rectified,
               "The images are rectified (use P of the CameraInfo and ignore D)");
  app.add_option("--trigger", bridge.taking,
                 "Trigger for accepting scans: arrival, always or command (default: arrival)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Taking>{
          {"arrival", Taking::arrived}, {"always", Taking::every}, {"command", Taking::command}}))
      ->option_text("arrival|always|command");
  app.add_option("--position-tolerance", bridge.position_tolerance,
                 "Position tolerance for arrival, in metres")
      ->check(CLI::Range(0.001, 100.0));
  app.add_option("--direction-tolerance-deg", options.direction_tolerance_deg,
                 "Direction tolerance for arrival, in degrees")
      ->check(CLI::Range(0.1, 180.0));
  app.add_option("--settling-time", bridge.settling,
                 "Time within both tolerances before a scan is accepted, in seconds")
      ->check(CLI::Range(0.0, 60.0));
  app.add_option("--max-pose-gap", bridge.history.longest_gap,
                 "Maximum gap between a scan and the odometry before and after it, in seconds")
      ->check(CLI::Range(0.001, 10.0));
  app.add_option("--odometry-timeout", bridge.patience,
                 "Maximum time that a scan waits for its odometry, in seconds")
      ->check(CLI::Range(0.0, 60.0));
  app.add_flag("--ignore-covariance", options.ignores_covariance,
               "Ignore the covariance of the odometry");
}

/// Throws Error{bad_usage} for an option that has no effect in combination with the others.
void require_effect(const CLI::App& app, const Options& options) {
  const bool has_world = !options.node.bridge.world.empty();
  const bool has_image = !options.node.image.empty();
  const bool asks_transforms = has_world || options.sensor.empty();
  const bool asks_arrival = options.node.bridge.taking == Taking::arrived;
  const auto require = [&](bool has_effect, std::initializer_list<const char*> names,
                           const std::string& condition) {
    for (const std::string name : names) {
      if (has_effect || app.get_option(name)->count() == 0) continue;
      throw skycap::Error(skycap::ErrorKind::bad_usage,
                          name + " has no effect " + condition + "; remove it");
    }
  };
  require(has_world, {"--base-frame"}, "without --fixed-frame");
  require(!has_world, {"--odometry", "--ignore-covariance"}, "with --fixed-frame");
  require(has_image, {"--camera-info", "--rectified"}, "without --image");
  require(!has_image, {"--cloud"}, "with --image");
  require(asks_transforms, {"--tf", "--tf-static"}, "with --sensor-pose and without --fixed-frame");
  require(asks_arrival, {"--position-tolerance", "--direction-tolerance-deg", "--settling-time"},
          "with --trigger always or command");
}

/// Converts options that are words or in degrees.
NodeConfig make_node_config(const Options& options) {
  NodeConfig node = options.node;
  node.bridge.uses_transforms = options.sensor.empty();
  node.bridge.mount = {options.sensor.empty()
                           ? Eigen::Isometry3d::Identity()
                           : skycap::ros2::parse_extrinsic(options.sensor, "--sensor-pose"),
                       options.axes};
  node.bridge.direction_tolerance =
      options.direction_tolerance_deg * skycap::geometry::radians_per_degree;
  node.bridge.uses_covariance = !options.ignores_covariance;
  return node;
}

}  // namespace

namespace {

/// Returns the arguments with version 0.1 options replaced by their current names, with a warning
/// for each. They are in reverse order, as CLI11 requires.
std::vector<std::string> current_arguments(int argc, char** argv) {
  static const std::map<std::string, std::string> former{
      {"--world", "--fixed-frame"},         {"--body", "--base-frame"},
      {"--sensor", "--sensor-pose"},        {"--take", "--trigger"},
      {"--patience", "--odometry-timeout"}, {"--pose-gap", "--max-pose-gap"},
      {"--settling", "--settling-time"}};
  static const std::map<std::string, std::string> former_triggers{{"arrived", "arrival"},
                                                                  {"every", "always"}};
  std::vector<std::string> arguments;
  for (int i = argc - 1; i > 0; --i) {
    std::string argument = argv[i];
    const auto equals = argument.find('=');
    const auto option = former.find(argument.substr(0, equals));
    if (option != former.end()) {
      std::cerr << "skycap_ros2: warning: " << option->first << " is now " << option->second
                << "; version 0.3 will not accept former names\n";
      std::string value = equals == std::string::npos ? "" : argument.substr(equals + 1);
      std::string& trigger =
          equals == std::string::npos && !arguments.empty() ? arguments.back() : value;
      if (option->first == "--take" && former_triggers.contains(trigger)) {
        trigger = former_triggers.at(trigger);
      }
      argument = option->second + (equals == std::string::npos ? "" : "=" + value);
    }
    arguments.push_back(std::move(argument));
  }
  return arguments;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Live survey for ROS 2 robots (docs/reference/ros2-topics.md)", "skycap_ros2");
  Options options;
  add_topics(app, options);
  add_rules(app, options);
  try {
    app.parse(current_arguments(argc, argv));
  } catch (const CLI::ParseError& failure) {
    return app.exit(failure);
  }
  try {
    require_effect(app, options);
    end_on_signals();
    run_node(make_node_config(options), is_stopped);
    return 0;
  } catch (const skycap::Error& failure) {
    std::cerr << "skycap_ros2: error: " << failure.what() << "\n";
    return failure.kind() == skycap::ErrorKind::bad_usage ? 2 : 1;
  } catch (const std::exception& failure) {
    std::cerr << "skycap_ros2: error: survey at " << options.node.address << ": " << failure.what()
              << "; the accepted scans are saved in its folder\n";
    return 1;
  }
}
