/// The scans of a rawlog with their poses, one after another: a rawlog may be larger than memory.
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
  std::string sensor;  ///< label of the one whose scans are wanted; needed if there are several
  /// A TUM trajectory of that sensor's optical frame, in place of what the rawlog says.
  std::optional<std::filesystem::path> poses;
};

struct RawlogFrame {
  std::string id;  ///< the sensor's label and the number of the observation
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();  ///< optical frame
  RawlogScan scan;
};

/// Poses are those of the trajectory that is given; else the rawlog's CObservationRobotPose; else
/// its actions' movements, added up from the first; else its CObservationOdometry. Those with times
/// are paired as in recorded_sequence.h. Without a trajectory the sensor is where `sensorPose` has
/// it on the carrier.
class RawlogSequence {
 public:
  /// Reads the rawlog once for its poses, and tells `report` how far it is; it may be empty. `note`
  /// is told, in a line, of each scan that is left out, and why. Throws Error{bad_file} for what
  /// cannot be read or has no poses or scans, and Error{bad_usage} if a sensor must be chosen.
  RawlogSequence(std::filesystem::path file, const RawlogChoice& choice,
                 std::function<void(const std::string&)> note,
                 const std::function<void(const std::string&)>& report = {});

  /// What poses are taken from, for the user.
  const std::string& pose_source() const { return pose_source_; }

  /// The next scan that can be used; nothing at the end. Throws Error{bad_file}.
  std::optional<RawlogFrame> next();

 private:
  void survey_file(const std::function<void(const std::string&)>& report);
  [[noreturn]] void fail(const std::string& what) const;
  void choose_sensor(const std::vector<std::string>& labels);
  void choose_poses(bool has_movements);
  Eigen::Isometry3d pose_of(const RawlogScan& scan) const;

  std::filesystem::path file_;
  RawlogChoice choice_;
  std::function<void(const std::string&)> note_;
  std::string pose_source_;
  std::vector<Stamped> trajectory_;
  std::vector<RawlogPose> poses_;
  std::unique_ptr<RawlogReader> reader_;
};

/// A rawlog's scan as one of the survey's.
ScanFound scan_of(const RawlogFrame& frame, const flight::CaptureOptions& capture,
                  const LiveOptions& live);

}  // namespace skycap::missions::online
