/// Point cloud formats of `skycap scan`.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

#include "flight/export/utm.h"
#include "missions/scan/cloud_file.h"
#include "missions/scan/coordinate_grid.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::scan {

/// Returns binary PLY: x y z and intensity as float, time as double, channel as ushort,
/// return_number and returns as uchar.
std::shared_ptr<const CloudFormat> ply_format();

/// Returns binary PCD 0.7 with the same fields as ply_format(), readable by the Point Cloud
/// Library.
std::shared_ptr<const CloudFormat> pcd_format();

/// Returns text with one line per point: x y z intensity time channel return_number returns.
/// Coordinates have a resolution of 0.1 mm, times of 0.1 us.
std::shared_ptr<const CloudFormat> xyz_format();

/// Returns E57 (ASTM E2807-11) with all points of a flight as one scan. Fields are cartesianX, Y
/// and Z as scaled integers, intensity, timeStamp (of the pulse), returnIndex and returnCount.
/// coordinateMetadata contains the grid's reference system. Throws all errors of
/// CoordinateGrid::validate().
std::shared_ptr<const CloudFormat> e57_format(const CoordinateGrid& grid,
                                              const std::string& sensor_name);

/// Scan data that formats may require. The trajectories must outlive the format.
struct CloudFormatContext {
  std::string sensor_name;
  const sim::LidarConfig& sensor;
  const sim::LidarFlight& flight;
  Eigen::Vector3d scene_centre;
  /// Map projection of LAS and E57 files. Null selects the mission frame, which all other formats
  /// use.
  std::shared_ptr<const flight::UtmProjection> projection;
};

/// Returns an MRPT rawlog with three observations per piece of the scan. CObservationRobotPose
/// contains the estimated trajectory. For spinning sensors, CObservationRotatingScan "LIDAR_RANGES"
/// contains the range image of the strongest returns. CObservationPointCloud "LIDAR_POINTS"
/// contains all returns in the sensor frame, compensated for the motion within the piece. Throws
/// Error{bad_file} if MRPT is not available.
std::shared_ptr<const CloudFormat> rawlog_format(const CloudFormatContext& context);

/// Name, file name extension and factory function of a format.
struct CloudFormatInfo {
  std::string name, extension;
  std::shared_ptr<const CloudFormat> (*make)(const CloudFormatContext& context);
};

/// Returns the format with this name, such as "las". Throws Error{bad_usage} listing the names.
const CloudFormatInfo& cloud_format_named(const std::string& name);

/// Returns the names for messages: "las, las7, ...".
std::string cloud_format_names();

}  // namespace skycap::missions::scan
