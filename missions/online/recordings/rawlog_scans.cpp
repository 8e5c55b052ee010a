#include "missions/online/recordings/rawlog_scans.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <string>

#include <mrpt/maps/CPointsMap.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationVelodyneScan.h>

namespace skycap::missions::online {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3f;
using mrpt::img::DistortionModel;
using Points = std::vector<Vector3f>;

/// Returns the rotation from the optical frame to MRPT's sensor frame.
Isometry3d sensor_from_optical() {
  Isometry3d turn = Isometry3d::Identity();
  turn.linear() = (Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();
  return turn;
}

/// Converts points x y z from MRPT's sensor frame to the optical frame.
Points in_optical(std::span<const float> x, std::span<const float> y, std::span<const float> z) {
  Points points;
  points.reserve(x.size());
  for (std::size_t i = 0; i < std::min({x.size(), y.size(), z.size()}); ++i) {
    const Vector3f point(-y[i], -z[i], x[i]);
    if (point.allFinite()) points.push_back(point);
  }
  return points;
}

/// Returns the reason why a camera's parameters are not valid intrinsics; empty if they are valid.
std::string find_defect(const mrpt::img::TCamera& camera) {
  const auto is_focal = [](double length) { return std::isfinite(length) && length > 0.0; };
  if (!is_focal(camera.fx()) || !is_focal(camera.fy()) || !std::isfinite(camera.cx()) ||
      !std::isfinite(camera.cy())) {
    return "missing focal length or principal point";
  }
  if (camera.distortion == DistortionModel::none) return {};
  if (camera.distortion != DistortionModel::plumb_bob) {
    return "fisheye lens; only Brown-Conrady distortion is supported";
  }
  const std::span<const double> known = std::span(camera.dist).first(5);
  const std::span<const double> others = std::span(camera.dist).subspan(5);
  const bool is_known = std::ranges::all_of(known, [](double k) { return std::isfinite(k); }) &&
                        std::ranges::all_of(others, [](double k) { return k == 0.0; });
  return is_known ? ""
                  : "distortion coefficients other than k1 k2 p1 p2 k3, or non-finite coefficients";
}

/// Returns true if the name is within the folder of the rawlog's images. Other paths on this
/// machine are not read.
bool is_plain_file_name(const std::string& name) {
  const std::filesystem::path path = name;
  const bool leaves = std::ranges::find(path, std::filesystem::path("..")) != path.end();
  return name.size() > 2 && path.is_relative() && !leaves;
}

/// Returns the reason why an observation's external file cannot be read; empty after success.
template <typename Observation>
std::string find_load_error(const Observation& observation, const std::string& name) {
  if (!is_plain_file_name(name)) return "stored in '" + name + "', outside the rawlog's folder";
  try {
    observation.load();
    return {};
  } catch (const std::exception&) {
    return "stored in '" + name + "', which does not exist or cannot be read";
  }
}

/// Returns true if the number of pixels or points exceeds that of the largest depth image file.
bool is_too_much(std::ptrdiff_t count) { return count > geometry::max_depth_pixels; }

/// Adds the points, or sets `fault` if there are too many.
void put_points(RawlogScan& scan, std::span<const float> x, std::span<const float> y,
                std::span<const float> z) {
  if (is_too_much(std::ssize(x))) {
    scan.fault = "more than 25 million points";
  } else {
    scan.content = in_optical(x, y, z);
  }
}

RecordedImage make_image(const mrpt::obs::CObservation3DRangeScan& observation) {
  const auto& ranges = observation.rangeImage;
  const mrpt::img::TCamera& camera = observation.cameraParams;
  RecordedImage image{
      .image = {static_cast<int>(ranges.cols()), static_cast<int>(ranges.rows()), {}},
      .unit = observation.rangeUnits,
      .is_depth = observation.range_is_depth,
      .focal_length_px = {camera.fx(), camera.fy()},
      .principal_point_px = {camera.cx(), camera.cy()}};
  image.image.values.assign(ranges.data(), ranges.data() + ranges.size());
  if (camera.distortion == DistortionModel::plumb_bob) {
    std::copy_n(camera.dist.begin(), image.distortion.size(), image.distortion.begin());
  }
  return image;
}

RawlogScan range_scan(const mrpt::obs::CObservation3DRangeScan& observation) {
  RawlogScan scan;
  if (observation.hasRangeImage) {
    if (observation.rangeImage_isExternallyStored()) {
      scan.fault = find_load_error(observation, observation.rangeImage_getExternalStorageFile(""));
    }
    if (scan.fault.empty()) scan.fault = find_defect(observation.cameraParams);
    const double unit = observation.rangeUnits;
    if (!(unit >= 1e-6 && unit <= 1.0)) scan.fault = "the depth unit must be from 1e-6 to 1 m";
    if (is_too_much(observation.rangeImage.size())) scan.fault = "more than 25 million pixels";
    if (scan.fault.empty()) scan.content = make_image(observation);
    return scan;
  }
  if (observation.hasPoints3D && observation.points3D_isExternallyStored()) {
    scan.fault = find_load_error(observation, observation.points3D_getExternalStorageFile());
  }
  if (!observation.hasPoints3D) scan.fault = "contains neither a range image nor points";
  if (scan.fault.empty()) {
    put_points(scan, observation.points3D_x, observation.points3D_y, observation.points3D_z);
  }
  return scan;
}

RawlogScan cloud_scan(const mrpt::obs::CObservationPointCloud& observation) {
  RawlogScan scan;
  if (observation.isExternallyStored()) {
    scan.fault = find_load_error(observation, observation.getExternalStorageFile());
  }
  if (scan.fault.empty() && !observation.pointcloud) scan.fault = "no points";
  if (!scan.fault.empty()) return scan;
  const mrpt::maps::CPointsMap& cloud = *observation.pointcloud;
  put_points(scan, cloud.getPointsBufferRef_x(), cloud.getPointsBufferRef_y(),
             cloud.getPointsBufferRef_z());
  return scan;
}

RawlogScan velodyne_scan(const mrpt::obs::CObservationVelodyneScan& observation) {
  mrpt::obs::CObservationVelodyneScan whole = observation;
  whole.generatePointCloud();
  RawlogScan scan;
  put_points(scan, whole.point_cloud.x, whole.point_cloud.y, whole.point_cloud.z);
  return scan;
}

}  // namespace

Isometry3d to_isometry(const mrpt::poses::CPose3D& pose) {
  Isometry3d isometry = Isometry3d::Identity();
  isometry.linear() = pose.getRotationMatrix().asEigen();
  isometry.translation() = Eigen::Vector3d(pose.x(), pose.y(), pose.z());
  return isometry;
}

std::optional<RawlogScan> make_scan(const mrpt::obs::CObservation& observation) {
  std::optional<RawlogScan> scan;
  if (const auto* range = dynamic_cast<const mrpt::obs::CObservation3DRangeScan*>(&observation)) {
    scan = range_scan(*range);
  } else if (const auto* cloud =
                 dynamic_cast<const mrpt::obs::CObservationPointCloud*>(&observation)) {
    scan = cloud_scan(*cloud);
  } else if (const auto* turning =
                 dynamic_cast<const mrpt::obs::CObservationVelodyneScan*>(&observation)) {
    scan = velodyne_scan(*turning);
  }
  if (!scan) return std::nullopt;
  mrpt::poses::CPose3D pose;
  observation.getSensorPose(pose);
  scan->platform_from_sensor = to_isometry(pose) * sensor_from_optical();
  return scan;
}

}  // namespace skycap::missions::online
