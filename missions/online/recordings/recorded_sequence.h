/// Sequences of depth images with poses, as other people recorded them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace skycap::missions::online {

struct RecordedFrame {
  std::string id;              ///< what the recording calls it
  std::filesystem::path file;  ///< a 16-bit PNG
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();  ///< optical frame
};

struct RecordedSequence {
  std::vector<RecordedFrame> frames;  ///< in the order of the recording
  std::vector<std::string> notes;     ///< a line for each frame that is left out, and why
  std::vector<std::string> remarks;   ///< what else was not taken as it stands in the lists
};

/// The first `count` frames, usable or not, of a folder in one of two layouts:
///
/// - TUM RGB-D: depth.txt with `time file` and groundtruth.txt with `time x y z qx qy qz qw` in
/// each
///   line, comments behind '#', times ascending. An image has the pose nearest in time, within 20
///   ms.
/// - 7-Scenes: frame-NNNNNN.depth.png and, beside it, frame-NNNNNN.pose.txt with a matrix.
///
/// Throws Error{bad_file} if the folder has neither, a list cannot be read (file and line), or no
/// frame is left.
RecordedSequence read_sequence(const std::filesystem::path& folder, std::size_t count);

}  // namespace skycap::missions::online
