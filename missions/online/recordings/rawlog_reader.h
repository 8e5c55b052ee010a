/// Rawlogs of MRPT, read by MRPT's own library: scans, and what they say of where they are from.
///
/// A rawlog is a row of observations, or of sensory frames with the carrier's movements between
/// them, compressed by gzip or not. MRPT's libraries are in a module that is loaded when somebody
/// asks for a rawlog, as for writing one, and read in a process of their own (reader_process.h).
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

/// An image of CObservation3DRangeScan, with its lens in the notation of OpenCV's calibration.
struct RecordedImage {
  geometry::DepthImage image;  ///< 0 is no return
  double unit = 0.001;         ///< what one step stands for [m]
  bool is_depth = true;        ///< along the optical axis; else along the pixel's ray
  Eigen::Vector2d focal_length_px, principal_point_px;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3
};

/// A scan. Its sensor's optical frame has x right, y down, z forward; MRPT's sensors have x
/// forward, y left, z up.
struct RawlogScan {
  std::size_t number = 0;  ///< of the observation in the file, from 0
  std::string label;       ///< of the sensor
  double time = 0.0;       ///< [s] since 1970
  Eigen::Isometry3d carrier_from_sensor = Eigen::Isometry3d::Identity();  ///< optical frame
  std::optional<Eigen::Isometry3d> moved;  ///< start from carrier, by the movements before it
  std::variant<RecordedImage, std::vector<Eigen::Vector3f>> content;  ///< or points, optical frame
  std::string fault;  ///< why the content cannot be used; empty if it can
};

enum class PoseSource {
  estimate,  ///< CObservationRobotPose: somebody's estimate in 6 dimensions
  odometry,  ///< CObservationOdometry: wheels, in the plane
};

struct RawlogPose {
  PoseSource source = PoseSource::estimate;
  double time = 0.0;                                                     ///< [s] since 1970
  Eigen::Isometry3d world_from_carrier = Eigen::Isometry3d::Identity();  ///< x forward, z up
};

class RawlogReader {
 public:
  virtual ~RawlogReader() = default;

  /// What comes next of the above; what else there is in the file is passed over. Nothing at the
  /// end. Throws Error{bad_file} naming the file and the entry for what MRPT cannot read, and for a
  /// file that ends within an entry.
  virtual std::optional<std::variant<RawlogScan, RawlogPose>> next() = 0;
};

/// Opens a rawlog. Images and clouds that it keeps in other files are looked for where MRPT does,
/// in NAME_Images beside it. Throws Error{bad_file}.
std::unique_ptr<RawlogReader> open_rawlog(const std::filesystem::path& file);

/// The module's function; what it returns is the caller's.
using MakeRawlogReader = RawlogReader*(const std::filesystem::path& file);
inline constexpr const char* make_rawlog_reader_name = "skycap_make_rawlog_reader";

}  // namespace skycap::missions::online
