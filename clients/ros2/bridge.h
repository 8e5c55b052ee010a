/// Between a robot's messages and a survey that is served: which scans are taken in, from where,
/// and what the robot is told. Knows nothing of DDS or sockets.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "clients/ros2/complaints.h"
#include "clients/ros2/frames.h"
#include "clients/ros2/pose_history.h"
#include "clients/ros2/sensor_scan.h"
#include "clients/ros2/transforms.h"
#include "clients/skycap_live.h"

namespace skycap::ros2 {

/// When a scan is taken in.
enum class Taking {
  arrived,  ///< from the view that was asked for, and from the way there if the mission measures
            ///< on it; the first one from anywhere, if none was
  every,    ///< whenever there is one
  command,  ///< when told
};

struct BridgeConfig {
  Mount mount{Eigen::Isometry3d::Identity(), Axes::optical};
  bool uses_transforms = false;  ///< TF says where the sensor is on the body, not `mount`
  std::string world;             ///< TF says where the body is in this frame; empty: odometry does
  std::string body = "base_link";  ///< the body's frame then; odometry says its own
  Taking taking = Taking::arrived;
  double position_tolerance = 0.3;   ///< from the view asked for [m]
  double direction_tolerance = 0.1;  ///< of the optical axis [rad]
  double settling = 0.5;  ///< the robot is within the tolerances for so long before the scan [s]
  double patience = 0.5;  ///< how long a scan waits for its odometry [s]
  HistoryConfig history;
  bool uses_covariance = true;  ///< of the odometry
  bool is_rectified = false;    ///< depth images
};

/// What is asked of `skycap serve`: all throw what skycap_live::Survey throws.
struct SurveyPort {
  std::function<std::string()> next, finish;
  std::function<std::string(const SensorScan&, const skycap_live::Pose&,
                            const skycap_live::PoseError&, skycap_live::From)>
      add;
  std::function<std::string(std::size_t id, const std::string& reason)> refuse;
};

/// Where the robot is wanted, in the odometry's frame or the one that was named.
struct Goal {
  std::string frame;
  Stamp stamp = 0;                        ///< of the pose that came last; 0: none yet
  std::optional<Eigen::Isometry3d> view;  ///< world from the optical frame
  std::vector<Eigen::Vector3d> path;      ///< proven way of the sensor there; empty: none
  std::optional<Mount> mount;             ///< as it is now, if it is known
};

struct Outlets {
  std::function<void(const Goal&)> goal;
  std::function<void(const std::string&)> status;  ///< a JSON object
  std::function<void(const std::string&)> warning;
};

class Bridge {
 public:
  Bridge(BridgeConfig config, SurveyPort survey, Outlets outlets);

  /// Asks for the first view.
  void begin();

  // Messages as they come, at `now` [s] of a clock that only goes forward. What is wrong with them
  // is said, and they are passed over.
  void receive(const Odometry& odometry, double now);
  void receive(const TFMessage& message, bool is_static, double now);
  void receive(const PointCloud2& cloud, double now);
  void receive(const CameraInfo& info, double now);
  void receive(const Image& image, double now);
  /// take, refuse REASON, finish.
  void receive(const String& command, double now);

  /// To be called after messages and a few times a second: takes in a scan whose pose is known now,
  /// gives up one that has waited too long, and notices that nobody serves the survey any more.
  void proceed(double now);

  /// What is going on, in a word or two of docs/reference/ros2-topics.md, for the status.
  void say(const std::string& doing);

  bool is_finished() const { return is_finished_; }

 private:
  struct Waiting {
    Stamp stamp;
    double since;
    SensorScan scan;
  };

  /// Body and sensor at a time; the mount counts if the body's pose is known.
  struct Whereabouts {
    PoseMatch body;
    Mount mount;
  };

  /// Complains of what `receive` throws.
  void guarded(const std::string& kind, double now, const std::function<void()>& receive);
  void complain(const std::string& kind, const std::string& line, double now);
  void add_odometry(const Odometry& odometry);
  void obey(const std::string& command);
  void add_scan(const Header& header, double now, const std::function<SensorScan()>& scan);
  bool wants_scan(double now) const;
  Whereabouts at(Stamp stamp) const;
  Whereabouts with_mount(const PoseMatch& body, Stamp stamp) const;
  std::optional<Mount> newest_mount() const;
  bool has_arrived(const Whereabouts& whereabouts) const;
  bool has_settled(Stamp stamp) const;
  bool measures_on_way() const;
  Stamp newest_stamp() const;
  void take(const Waiting& waiting, const Whereabouts& whereabouts, double now);
  void locate();
  void learn(const std::string& answer, skycap_live::From from = skycap_live::From::view);
  void publish_goal();
  void publish_status();

  BridgeConfig config_;
  SurveyPort survey_;
  Outlets outlets_;
  Complaints complaints_;
  PoseHistory history_;
  Transforms transforms_;
  std::string world_frame_, body_frame_, sensor_frame_;
  bool is_located_ = false;   ///< something said where the body is
  bool lacks_mount_ = false;  ///< the goal that was published
  Stamp newest_pose_ = 0;     ///< of the odometry that came last
  std::optional<CameraLens> lens_;
  std::optional<Waiting> waiting_;
  nlohmann::json answer_;                  ///< the last one of the survey
  std::optional<Eigen::Isometry3d> view_;  ///< that was asked for
  Stamp last_taken_ = 0;
  std::size_t taken_ = 0;
  bool is_told_to_take_ = false;
  bool holds_ = false;  ///< a pose was wrong: nothing is taken in until told
  bool is_finished_ = false;
  double not_before_ = 0.0;  ///< next scan, after one that was refused
  double asked_at_ = 0.0;    ///< when the survey was last heard of
  std::string doing_, status_;
};

}  // namespace skycap::ros2
