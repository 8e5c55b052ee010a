/// Scans as other people's sensors and programs write them: clouds and depth images.
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
#include "geometry/place/camera.h"
#include "geometry/points/depth_image.h"
#include "geometry/points/scan.h"
#include "missions/online/live/live_options.h"
#include "missions/online/live/scan_filter.h"

namespace skycap::missions::online {

/// How the pixels of a depth image look out of a lens: a pinhole with the distortion of Brown and
/// Conrady, in the notation of OpenCV's calibration.
struct Lens {
  Eigen::Vector2d focal_length_px, principal_point_px;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3

  /// The ray through a pixel, with z = 1, in the optical frame; nothing where the lens maps no ray
  /// there.
  std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& pixel) const;
};

/// Reads "fx fy cx cy" and, if they are given, "k1 k2 p1 p2 k3". Throws Error{bad_usage}.
Lens parse_lens(const std::string& text, const std::string& what = "--intrinsics");

/// A pose from 7 numbers "x y z qx qy qz qw", 12 or 16 (a matrix by rows), or 8 (a line of a TUM
/// trajectory, whose time is passed over); `what` opens messages. Throws Error{bad_file}.
Eigen::Isometry3d parse_pose_text(const std::string& text, const std::string& what);

/// Reads some finite numbers, up to 36. Throws Error{bad_file}; `what` opens messages.
std::vector<double> parse_numbers(const std::string& text, const std::string& what);

struct ScanInput {
  std::filesystem::path
      file;  ///< .png: a depth image; else a cloud that geometry::read_cloud reads
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();  ///< optical frame
  bool is_in_world = false;   ///< the cloud's points are in the world frame already
  std::optional<Lens> lens;   ///< of a depth image; else the survey's camera
  double depth_unit = 0.001;  ///< what a step of a depth image stands for [m]
};

/// A scan, and what of the file did not go into it.
struct ScanFound {
  geometry::Scan scan;
  std::size_t without_return = 0;  ///< pixels of 0 or 65535, or without a ray of the lens
  std::size_t out_of_view = 0;     ///< points that the survey's camera cannot see from that pose
  std::size_t hidden = 0;          ///< farther away than another point in the same pixel
  LeftOut left_out;                ///< if LiveOptions asks for it
};

/// Reads a scan for a survey. With a depth camera each point gets the pixel of the survey's camera
/// that it is seen in, whatever the file's own order is; with a scanner the points are taken as
/// they are. Throws Error{bad_file} naming the file.
ScanFound read_scan(const ScanInput& input, const flight::CaptureOptions& capture,
                    const LiveOptions& live);

/// The points of a depth image in its optical frame; `without_return` counts the others.
std::vector<Eigen::Vector3d> points_of(const geometry::DepthImage& image, const Lens& lens,
                                       double unit, std::size_t& without_return);

/// Points of the sensor's optical frame as a scan of a survey, as read_scan has it.
ScanFound scan_of(std::span<const Eigen::Vector3d> points,
                  const Eigen::Isometry3d& world_from_sensor, const flight::CaptureOptions& capture,
                  const LiveOptions& live);

/// A depth image as a scan of a survey with a depth camera; without a lens, of the survey's.
ScanFound scan_of(const geometry::DepthImage& image, const std::optional<Lens>& lens, double unit,
                  const Eigen::Isometry3d& world_from_sensor, const flight::CaptureOptions& capture,
                  const LiveOptions& live);

/// Leaves out flying pixels and isolated returns, if the options ask for it.
LeftOut filter(geometry::Scan& scan, const geometry::CameraConfig& camera, const LiveOptions& live);

/// Throws Error{bad_geometry} unless a scan is one that planner and vehicle can take in: points at
/// places, pixels (which a vehicle with a camera needs) of the survey's camera and ascending.
void require_usable(const geometry::Scan& scan, const flight::FlightOptions& flight);

}  // namespace skycap::missions::online
