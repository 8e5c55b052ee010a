/// Import of external scans: point clouds and depth images.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/flight_options.h"
#include "geometry/points/depth_image.h"
#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"
#include "missions/online/live/live_options.h"
#include "missions/online/live/scan_filter.h"

namespace skycap::missions::online {

/// Intrinsics of a depth image: pinhole camera with Brown-Conrady distortion, in OpenCV's notation.
struct CameraIntrinsics {
  Eigen::Vector2d focal_length_px, principal_point_px;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3

  /// Returns the ray through a pixel in the optical frame, scaled to z = 1. Returns an empty value
  /// if no ray is projected to this pixel.
  std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& pixel) const;
};

/// Parses "fx fy cx cy", optionally followed by "k1 k2 p1 p2 k3". Throws Error{bad_usage}.
CameraIntrinsics parse_intrinsics(const std::string& text,
                                  const std::string& what = "--intrinsics");

/// Parses a pose from 7 numbers "x y z qx qy qz qw", 12 or 16 numbers (a matrix, row by row), or 8
/// numbers (a line of a TUM trajectory, whose time is ignored). `what` is the prefix of error
/// messages. Throws Error{bad_file}.
Eigen::Isometry3d parse_pose_text(const std::string& text, const std::string& what);

/// Parses up to 36 finite numbers. `what` is the prefix of error messages. Throws Error{bad_file}.
std::vector<double> parse_numbers(const std::string& text, const std::string& what);

struct ScanInput {
  std::filesystem::path
      file;  ///< Depth image (.png) or a cloud in a format of geometry::read_cloud().
  /// Pose of the optical frame.
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();
  bool is_in_world = false;  ///< The cloud's points are in the world frame.
  /// Intrinsics of the depth image (default: those of the survey's camera).
  std::optional<CameraIntrinsics> intrinsics;
  double depth_unit = 0.001;  ///< Depth per unit of a pixel value [m].
};

/// Imported scan with the numbers of excluded points.
struct ScanFound {
  geometry::Scan scan;
  std::size_t without_return = 0;  ///< Pixels with value 0 or 65535 or without a ray.
  std::size_t out_of_view = 0;     ///< Points outside the survey camera's view at this pose.
  std::size_t hidden = 0;          ///< Points behind another point in the same pixel.
  LeftOut left_out;                ///< Points removed by filter().
};

/// Reads a scan for a survey. For depth cameras, each point is assigned the pixel of the survey's
/// camera that it projects to, independent of the file's order. For scanners, points are used
/// unchanged. Throws Error{bad_file} naming the file.
ScanFound read_scan(const ScanInput& input, const flight::CaptureOptions& capture,
                    const LiveOptions& live);

/// Returns the points of a depth image in its optical frame. `without_return` is set to the number
/// of pixels without a point.
std::vector<Eigen::Vector3d> unproject_points(const geometry::DepthImage& image,
                                              const CameraIntrinsics& intrinsics, double unit,
                                              std::size_t& without_return);

/// Converts points in the sensor's optical frame to a scan, like read_scan().
ScanFound make_scan(std::span<const Eigen::Vector3d> points,
                    const Eigen::Isometry3d& world_from_sensor,
                    const flight::CaptureOptions& capture, const LiveOptions& live);

/// Converts a depth image to a scan of a survey with a depth camera. `intrinsics` defaults to the
/// intrinsics of the survey's camera. `unit` is the depth per unit of a pixel value [m].
ScanFound make_scan(const geometry::DepthImage& image,
                    const std::optional<CameraIntrinsics>& intrinsics, double unit,
                    const Eigen::Isometry3d& world_from_sensor,
                    const flight::CaptureOptions& capture, const LiveOptions& live);

/// Removes flying pixels and isolated returns if enabled in `live`.
LeftOut filter(geometry::Scan& scan, const geometry::CameraConfig& camera, const LiveOptions& live);

/// Throws Error{bad_geometry} if the scan is unusable for the planner or the vehicle. Points must
/// be finite and within the coordinate range. Pixels must be in ascending order and within the
/// image of the survey's camera. They are required for vehicles with a camera.
void require_usable(const geometry::Scan& scan, const flight::FlightOptions& flight);

}  // namespace skycap::missions::online
