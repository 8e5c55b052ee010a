/// Bridge between a robot's messages and a served survey. It selects scans, determines their poses
/// and publishes goals. Independent of DDS and sockets.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "clients/ros2/frames.h"
#include "clients/ros2/pose_history.h"
#include "clients/ros2/sensor_scan.h"
#include "clients/ros2/throttled_warnings.h"
#include "clients/ros2/transforms.h"
#include "clients/skycap_live.h"

namespace skycap::ros2 {

/// Condition for accepting a scan.
enum class Taking {
  /// At the requested view, and en route if the mission measures there. Without a requested view,
  /// the first scan from anywhere.
  arrived,
  every,    ///< Every available scan.
  command,  ///< On command.
};

struct BridgeConfig {
  Mount mount{Eigen::Isometry3d::Identity(), Axes::optical};
  bool uses_transforms = false;  ///< Sensor mount on the body from TF instead of `mount`.
  std::string world;  ///< World frame in which TF locates the body. Empty: odometry locates it.
  std::string body = "base_link";  ///< Body frame for TF. Odometry specifies its own.
  Taking taking = Taking::arrived;
  double position_tolerance = 0.3;  ///< Maximum distance from the requested view [m].
  /// Maximum angle of the optical axis to the requested view [rad].
  double direction_tolerance = 0.1;
  double settling = 0.5;  ///< Time within the tolerances before a scan is accepted [s].
  double patience = 0.5;  ///< Maximum time that a scan waits for its odometry [s].
  HistoryConfig history;
  bool uses_covariance = true;  ///< Use the covariance of the odometry.
  bool is_rectified = false;    ///< Depth images are rectified.
};

/// Requests to `skycap serve`. All throw the same errors as skycap_live::Survey.
struct SurveyPort {
  std::function<std::string()> next, finish;
  std::function<std::string(const SensorScan&, const skycap_live::Pose&,
                            const skycap_live::PoseError&, skycap_live::From)>
      add;
  std::function<std::string(std::size_t id, const std::string& reason)> reject;
};

/// Requested pose in the frame of the odometry, or in the configured world frame.
struct Goal {
  std::string frame;
  Stamp stamp = 0;                        ///< Stamp of the latest pose. 0: no pose yet.
  std::optional<Eigen::Isometry3d> view;  ///< World from the optical frame.
  std::vector<Eigen::Vector3d> path;  ///< Verified path of the sensor to the view. Empty: no path.
  std::optional<Mount> mount;         ///< Current mount, if known.
};

struct BridgeCallbacks {
  std::function<void(const Goal&)> goal;
  std::function<void(const std::string&)> status;  ///< Publishes a JSON object.
  std::function<void(const std::string&)> warning;
};

class Bridge {
 public:
  Bridge(BridgeConfig config, SurveyPort survey, BridgeCallbacks callbacks);

  /// Requests the first view.
  void begin();

  // Processes messages as they arrive, at `now` [s] of a monotonic clock. Errors in messages are
  // reported as warnings, and the messages are skipped.
  void receive(const Odometry& odometry, double now);
  void receive(const TFMessage& message, bool is_static, double now);
  void receive(const PointCloud2& cloud, double now);
  void receive(const CameraInfo& info, double now);
  void receive(const Image& image, double now);
  /// Processes a command: take, refuse REASON or finish.
  void receive(const String& command, double now);

  /// Must be called after messages and several times per second. Adds a waiting scan once its pose
  /// is known, discards one that has waited too long, and detects the loss of the server.
  void proceed(double now);

  /// Publishes the current activity, one of the terms in docs/reference/ros2-topics.md, in the
  /// status.
  void set_status(const std::string& doing);

  bool is_finished() const { return is_finished_; }

 private:
  struct Waiting {
    Stamp stamp;
    double since;
    SensorScan scan;
  };

  /// Body and sensor poses at one time. The mount is valid only if the body pose is known.
  struct PoseState {
    PoseMatch body;
    Mount mount;
  };

  /// Calls `receive` and reports its errors as warnings.
  void guarded(const std::string& kind, double now, const std::function<void()>& receive);
  void warn_throttled(const std::string& kind, const std::string& line, double now);
  void add_odometry(const Odometry& odometry);
  void obey(const std::string& command);
  void add_scan(const Header& header, double now, const std::function<SensorScan()>& scan);
  bool wants_scan(double now) const;
  PoseState at(Stamp stamp) const;
  PoseState with_mount(const PoseMatch& body, Stamp stamp) const;
  std::optional<Mount> newest_mount() const;
  bool has_arrived(const PoseState& pose_state) const;
  bool has_settled(Stamp stamp) const;
  bool measures_en_route() const;
  Stamp newest_stamp() const;
  void submit_scan(const Waiting& waiting, const PoseState& pose_state, double now);
  void locate();
  void learn(const std::string& answer, skycap_live::From from = skycap_live::From::view);
  void publish_goal();
  void publish_status();

  BridgeConfig config_;
  SurveyPort survey_;
  BridgeCallbacks callbacks_;
  ThrottledWarnings warnings_;
  PoseHistory history_;
  Transforms transforms_;
  std::string world_frame_, body_frame_, sensor_frame_;
  bool is_located_ = false;   ///< True once the body pose is known.
  bool lacks_mount_ = false;  ///< True if the published goal lacks the mount.
  Stamp newest_pose_ = 0;     ///< Stamp of the latest odometry.
  std::optional<CameraIntrinsics> intrinsics_;
  std::optional<Waiting> waiting_;
  nlohmann::json answer_;                  ///< Last answer of the survey.
  std::optional<Eigen::Isometry3d> view_;  ///< Requested view.
  Stamp last_added_ = 0;
  std::size_t added_scans_ = 0;
  bool is_add_requested_ = false;
  bool is_suspended_ =
      false;  ///< True after an inconsistent pose: no scans are added until a command.
  bool is_finished_ = false;
  double not_before_ = 0.0;  ///< Earliest time of the next scan after a rejected one [s].
  double asked_at_ = 0.0;    ///< Time of the last contact with the survey [s].
  std::string doing_, status_;
};

}  // namespace skycap::ros2
