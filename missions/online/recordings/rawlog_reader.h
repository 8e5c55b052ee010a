/// Reader of the scans and poses in MRPT rawlogs, based on the MRPT library.
///
/// A rawlog is a sequence of observations, or of sensory frames with the platform's movements
/// between them, optionally compressed by gzip. The MRPT libraries are in a module that is loaded
/// on demand. They read files in a separate process (reader_process.h).
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/depth_image.h"

namespace skycap::missions::online {

/// Depth image of a CObservation3DRangeScan with intrinsics in OpenCV's notation.
struct RecordedImage {
  geometry::DepthImage image;  ///< Depth image; no-return pixels are 0.
  double unit = 0.001;         ///< Depth per unit of a pixel value [m].
  /// Values are depths along the optical axis; otherwise ranges along the pixel's ray.
  bool is_depth = true;
  Eigen::Vector2d focal_length_px, principal_point_px;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3
};

/// Scan of a rawlog. The optical frame of its sensor has x right, y down, z forward. MRPT's sensor
/// frames have x forward, y left, z up.
struct RawlogScan {
  std::size_t number = 0;  ///< Index of the observation in the file, from 0.
  std::string label;       ///< Label of the sensor.
  double time = 0.0;       ///< Seconds since 1970.
  /// Pose of the optical frame.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  /// Pose of the platform relative to its start, from the accumulated movements.
  std::optional<Eigen::Isometry3d> moved;
  /// Depth image, or points in the optical frame.
  std::variant<RecordedImage, std::vector<Eigen::Vector3f>> content;
  std::string fault;  ///< Reason why the content is unusable; empty if it is usable.
};

enum class PoseSource {
  estimate,  ///< CObservationRobotPose: 6-DoF estimate from another program.
  odometry,  ///< CObservationOdometry: planar wheel odometry.
};

struct RawlogPose {
  PoseSource source = PoseSource::estimate;
  double time = 0.0;  ///< Seconds since 1970.
  /// Platform frame: x forward, z up.
  Eigen::Isometry3d world_from_platform = Eigen::Isometry3d::Identity();
};

class RawlogReader {
 public:
  virtual ~RawlogReader() = default;

  /// Returns the next scan or pose and skips other entries. Returns an empty value at the end.
  /// Throws Error{bad_file} naming the file and the entry if MRPT cannot read it or the file ends
  /// within an entry.
  virtual std::optional<std::variant<RawlogScan, RawlogPose>> next() = 0;
};

/// Opens a rawlog. External images and clouds are searched for in the folder NAME_Images next to
/// the file, as in MRPT. Throws Error{bad_file}.
std::unique_ptr<RawlogReader> open_rawlog(const std::filesystem::path& file);

/// Entry point of the module. The caller owns the returned object.
using MakeRawlogReader = RawlogReader*(const std::filesystem::path& file);
inline constexpr const char* make_rawlog_reader_name = "skycap_make_rawlog_reader";

}  // namespace skycap::missions::online
