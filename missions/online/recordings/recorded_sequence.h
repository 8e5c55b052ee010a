/// Recorded sequences of depth images with poses.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace skycap::missions::online {

struct RecordedFrame {
  std::string id;              ///< Identifier of the frame in the recording.
  std::filesystem::path file;  ///< Depth image, 16-bit PNG.
  /// Pose of the optical frame.
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();
};

struct RecordedSequence {
  std::vector<RecordedFrame> frames;  ///< Frames in recording order.
  std::vector<std::string> notes;     ///< One line for each skipped frame, with the reason.
  std::vector<std::string> remarks;   ///< Notes about other deviations from the lists.
};

/// Reads the first `count` frames of a folder, usable or not, in one of two layouts:
///
/// - TUM RGB-D: depth.txt with `time file` and groundtruth.txt with `time x y z qx qy qz qw` in
///   each line, comments after '#', times ascending. Each image has the pose nearest in time,
///   within 20 ms.
/// - 7-Scenes: frame-NNNNNN.depth.png and frame-NNNNNN.pose.txt, which contains a matrix.
///
/// Throws Error{bad_file} if the folder has neither layout, a list cannot be read (naming file and
/// line), or no frame is usable.
RecordedSequence read_sequence(const std::filesystem::path& folder, std::size_t count);

}  // namespace skycap::missions::online
