/// Sequential access to the scans of a rawlog with their poses. A rawlog may be larger than memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "flight/flight_options.h"
#include "missions/online/live/live_options.h"
#include "missions/online/live/scan_input.h"
#include "missions/online/recordings/rawlog_reader.h"
#include "missions/online/recordings/stamped_list.h"

namespace skycap::missions::online {

struct RawlogChoice {
  std::string sensor;  ///< Label of the sensor to read. Required if the rawlog has several sensors.
  /// TUM trajectory of the sensor's optical frame. Replaces the poses of the rawlog.
  std::optional<std::filesystem::path> poses;
};

struct RawlogFrame {
  std::string id;  ///< Label of the sensor and index of the observation.
  /// Pose of the optical frame.
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();
  RawlogScan scan;
};

/// Scans of one sensor with poses. Poses are taken from the first available source: the given
/// trajectory, CObservationRobotPose, the accumulated movements of the rawlog's actions,
/// CObservationOdometry. Poses with times are matched as in recorded_sequence.h. Without a
/// trajectory, `sensorPose` defines the pose of the sensor on the platform.
class RawlogSequence {
 public:
  /// Reads the whole rawlog once for its poses. `report` (optional) receives the progress. `note`
  /// receives one line for each skipped scan with the reason. Throws Error{bad_file} if the file
  /// cannot be read or has no poses or no scans, and Error{bad_usage} if a sensor must be chosen.
  RawlogSequence(std::filesystem::path file, const RawlogChoice& choice,
                 std::function<void(const std::string&)> note,
                 const std::function<void(const std::string&)>& report = {});

  /// Returns the description of the pose source for the user.
  const std::string& pose_source() const { return pose_source_; }

  /// Returns the next usable scan, or an empty value at the end. Throws Error{bad_file}.
  std::optional<RawlogFrame> next();

 private:
  void survey_file(const std::function<void(const std::string&)>& report);
  [[noreturn]] void fail(const std::string& what) const;
  void choose_sensor(const std::vector<std::string>& labels);
  void choose_poses(bool has_movements);
  Eigen::Isometry3d compute_pose(const RawlogScan& scan) const;

  std::filesystem::path file_;
  RawlogChoice choice_;
  std::function<void(const std::string&)> note_;
  std::string pose_source_;
  std::vector<Stamped> trajectory_;
  std::vector<RawlogPose> poses_;
  std::unique_ptr<RawlogReader> reader_;
};

/// Converts a rawlog's scan to a scan of the survey.
ScanFound make_scan(const RawlogFrame& frame, const flight::CaptureOptions& capture,
                    const LiveOptions& live);

}  // namespace skycap::missions::online
