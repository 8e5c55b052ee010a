/// The formats that `skycap scan` writes points in.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

#include "flight/export/utm.h"
#include "missions/scan/cloud_file.h"
#include "missions/scan/coordinate_grid.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::scan {

/// Binary PLY: x y z and intensity as float, time as double, channel as ushort, return_number and
/// returns as uchar.
std::shared_ptr<const CloudFormat> ply_format();

/// Binary PCD 0.7 with the same fields, as the Point Cloud Library reads them.
std::shared_ptr<const CloudFormat> pcd_format();

/// A line of x y z intensity time channel return_number returns for each point; tenths of a
/// millimetre and of a microsecond.
std::shared_ptr<const CloudFormat> xyz_format();

/// E57 (ASTM E2807-11), all points of a flight as one scan: cartesianX, Y and Z as scaled integers,
/// intensity, timeStamp (the shot's), returnIndex and returnCount; coordinateMetadata is the grid's
/// reference system. Throws what CoordinateGrid::validate() throws.
std::shared_ptr<const CloudFormat> e57_format(const CoordinateGrid& grid,
                                              const std::string& sensor_name);

/// What a format may need to know of the scan; the trajectories must outlive the format.
struct CloudFormatContext {
  std::string sensor_name;
  const sim::LidarConfig& sensor;
  const sim::LidarFlight& flight;
  Eigen::Vector3d scene_centre;
  /// Where LAS and E57 files have their points; none: in the mission's frame, as all others do.
  std::shared_ptr<const flight::UtmProjection> projection;
};

/// A rawlog of MRPT, for every piece of the scan: CObservationRobotPose "CARRIER" (of the believed
/// trajectory), of spinning sensors CObservationRotatingScan "LIDAR_RANGES" (the range image of
/// the strongest returns), and CObservationPointCloud "LIDAR_POINTS" (all returns in the sensor's
/// frame, free of the motion within the piece). Throws Error{bad_file} if MRPT is not there.
std::shared_ptr<const CloudFormat> rawlog_format(const CloudFormatContext& context);

/// A format's name, its files' ending and how to make it.
struct CloudFormatInfo {
  std::string name, ending;
  std::shared_ptr<const CloudFormat> (*make)(const CloudFormatContext& context);
};

/// The format of that name, such as "las". Throws Error{bad_usage} listing the names.
const CloudFormatInfo& cloud_format_named(const std::string& name);

/// "las, las7, ...".
std::string cloud_format_names();

}  // namespace skycap::missions::scan
