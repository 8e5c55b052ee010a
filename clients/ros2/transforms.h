/// Tree of frames from /tf and /tf_static, for the pose of one frame in another at a given time.
///
/// The parent of a frame is fixed by the first message that contains it. Transforms of /tf_static
/// are constant. The others are valid at their stamps and are interpolated like odometry
/// (PoseHistory).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "clients/ros2/messages.h"
#include "clients/ros2/pose_history.h"

namespace skycap::ros2 {

/// Pose of a frame from the latest transforms.
struct NewestTransform {
  Eigen::Isometry3d target_from_source = Eigen::Isometry3d::Identity();
  Stamp stamp = 0;  ///< Latest stamp on the chain between the frames. 0 if all are static.
};

class Transforms {
 public:
  static constexpr std::size_t max_frames = 256;
  /// Per frame. The first to arrive is removed first.
  static constexpr std::size_t max_poses = 1000;
  static constexpr int longest_chain = 64;  ///< Maximum number of frames up to the root.

  explicit Transforms(HistoryConfig config);

  /// Adds a transform. Throws Error{bad_geometry} with the problem: an empty name or one above 100
  /// bytes, values that are not finite, or a quaternion that is not normalised. Further problems
  /// are a missing stamp, a changed parent, a different pose at the same stamp, a frame both static
  /// and moving, and too many frames.
  void add(const TransformStamped& transform, bool is_static);

  /// Returns `target` from `source` at a stamp, without covariance. A frame relative to itself is
  /// the identity, even if unknown.
  PoseMatch at(const std::string& target, const std::string& source, Stamp stamp) const;

  /// Returns `target` from `source` according to the latest transform of each frame.
  std::optional<NewestTransform> newest(const std::string& target, const std::string& source) const;

 private:
  struct Frame {
    std::string parent;
    std::optional<BodyPose> fixed;  ///< Constant pose in the parent.
    PoseHistory history;            ///< Poses of a moving frame.
    BodyPose last;
    Stamp last_stamp;  ///< 0 if static.
  };
  struct Found {
    PoseMatch match;
    Stamp newest = 0;  ///< Latest stamp of the frames on the chain.
  };
  /// Returns the pose at the stamp, or the latest one without a stamp.
  static PoseMatch in_parent(const Frame& frame, std::optional<Stamp> stamp);
  Found find(const std::string& target, const std::string& source,
             std::optional<Stamp> stamp) const;

  HistoryConfig config_;
  std::map<std::string, Frame> frames_;
};

}  // namespace skycap::ros2
