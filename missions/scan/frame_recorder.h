/// Recording of a depth camera's images along a flight, as a dataset in the layout of the TUM RGB-D
/// benchmark: depth_NNNNNN.png, depth.txt, groundtruth.txt.
#pragma once

#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/io/output_folder.h"
#include "missions/scan/scan_journal.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"

namespace skycap::missions::scan {

/// Image to record, with the actual and the estimated camera pose.
struct Frame {
  double time = 0.0;  ///< [s]
  /// Actual pose of the optical frame.
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  /// Estimated pose of the optical frame.
  Eigen::Isometry3d estimated_from_camera = Eigen::Isometry3d::Identity();
};

struct FrameOptions {
  double depth_unit = 0.001;  ///< Depth per unit of a pixel value [m].
  bool has_rawlog = false;    ///< Write frames.rawlog in addition.
  unsigned threads = 0;
  nlohmann::ordered_json begun;    ///< Journal checkpoint to resume from, or null.
  double checkpoint_period = 5.0;  ///< Minimum time between two checkpoints [s].
  /// Called after each image; may be empty.
  std::function<void(std::size_t frames, std::size_t points)> report;
  std::stop_token stop;
};

struct FrameResult {
  std::size_t frames = 0;  ///< Number of recorded images, fewer than requested after a stop.
  std::size_t points = 0;
  double time = 0.0;  ///< Computation time including interrupted runs [s].
};

/// Records the images with `journal`, which allows the recording to be resumed, and stages the
/// results in `folder`; the caller commits. Results are the images, depth.txt (`time file` per
/// image), groundtruth.txt and estimated.txt (TUM poses of the camera). Further results are
/// camera.json (intrinsics, unit) and preview.ply (preview.h).
///
/// The optional frames.rawlog contains two observations per image. CObservationRobotPose is the
/// estimated pose of the camera with x forward, and CObservation3DRangeScan "DEPTH" is the image.
/// Throws Error{bad_file} if a file cannot be written or MRPT is not available.
FrameResult record_frames(const sim::Scene& scene, const sim::DepthCamera& camera,
                          std::span<const Frame> frames, ScanJournal& journal,
                          geometry::OutputFolder& folder, const FrameOptions& options);

}  // namespace skycap::missions::scan
