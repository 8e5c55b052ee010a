/// The images of a depth camera along a flight, as a dataset in the manner of the TUM RGB-D
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

/// An image to take, and where its camera believes that it was taken from.
struct Frame {
  double time = 0.0;                                                       ///< [s]
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();     ///< optical frame
  Eigen::Isometry3d believed_from_camera = Eigen::Isometry3d::Identity();  ///< the same, believed
};

struct FrameOptions {
  double depth_unit = 0.001;  ///< what one step of the images stands for [m]
  bool has_rawlog = false;    ///< whether frames.rawlog is written too
  unsigned threads = 0;
  nlohmann::ordered_json begun;    ///< a checkpoint of the journal to go on from, or null
  double checkpoint_period = 5.0;  ///< between two of them, at least [s]
  std::function<void(std::size_t frames, std::size_t points)> report;  ///< after each; may be empty
  std::stop_token stop;
};

struct FrameResult {
  std::size_t frames = 0;  ///< fewer than asked for if it was stopped
  std::size_t points = 0;
  double time = 0.0;  ///< that the simulation took, with that of interrupted runs [s]
};

/// Takes the images into `journal`, in which the recording can be gone on with, and stages in
/// `folder`, whose caller commits: the images, depth.txt (`time file` of each),
/// groundtruth.txt and estimated.txt (TUM poses of the camera), camera.json (intrinsics, unit),
/// preview.ply (preview.h), and on demand frames.rawlog: for each image a CObservationRobotPose
/// "CARRIER", where the camera is believed to be, with x forward, and a CObservation3DRangeScan
/// "DEPTH". Throws Error{bad_file} if a file cannot be written or MRPT is not there.
FrameResult record_frames(const sim::Scene& scene, const sim::DepthCamera& camera,
                          std::span<const Frame> frames, ScanJournal& journal,
                          geometry::OutputFolder& folder, const FrameOptions& options);

}  // namespace skycap::missions::scan
