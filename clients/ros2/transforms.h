/// The tree of frames that /tf and /tf_static tell of: where one frame is in another at a time.
///
/// Each frame has one parent, from the first message that names it on. Those of /tf_static hold for
/// ever; the others at their stamps and between, as odometry does (PoseHistory).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "clients/ros2/messages.h"
#include "clients/ros2/pose_history.h"

namespace skycap::ros2 {

/// Where a frame is by what came last.
struct NewestTransform {
  Eigen::Isometry3d target_from_source = Eigen::Isometry3d::Identity();
  Stamp stamp = 0;  ///< the latest on the way from one to the other; 0 if nothing there moves
};

class Transforms {
 public:
  static constexpr std::size_t most_frames = 256;
  static constexpr std::size_t most_poses = 1000;  ///< of each frame; the first go first
  static constexpr int longest_chain = 64;         ///< of frames, up to the root

  explicit Transforms(HistoryConfig config);

  /// Throws Error{bad_geometry} saying what is wrong: names that are empty or longer than 100
  /// bytes, numbers that are none, a quaternion whose length is not one, a stamp that is not set,
  /// another parent than before, another pose at the same stamp, a frame that is static here and
  /// moves there, more frames than there may be.
  void add(const TransformStamped& transform, bool is_static);

  /// `target` from `source` at a stamp; without covariance. A frame is itself, known or not.
  PoseMatch at(const std::string& target, const std::string& source, Stamp stamp) const;

  /// The same by what came last of each frame.
  std::optional<NewestTransform> newest(const std::string& target, const std::string& source) const;

 private:
  struct Frame {
    std::string parent;
    std::optional<BodyPose> fixed;  ///< in the parent, for ever
    PoseHistory history;            ///< and if it moves
    BodyPose last;
    Stamp last_stamp;  ///< 0 if it is static
  };
  struct Found {
    PoseMatch match;
    Stamp newest = 0;  ///< of what came last of the frames on the way
  };
  /// What came last if there is no stamp.
  static PoseMatch in_parent(const Frame& frame, std::optional<Stamp> stamp);
  Found find(const std::string& target, const std::string& source,
             std::optional<Stamp> stamp) const;

  HistoryConfig config_;
  std::map<std::string, Frame> frames_;
};

}  // namespace skycap::ros2
