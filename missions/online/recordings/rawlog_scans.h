/// Conversion of MRPT observations to scans, for the module only.
#pragma once

#include <optional>

#include <Eigen/Geometry>

#include "missions/online/recordings/rawlog_reader.h"

namespace mrpt::obs {
class CObservation;
}
namespace mrpt::poses {
class CPose3D;
}

namespace skycap::missions::online {

Eigen::Isometry3d to_isometry(const mrpt::poses::CPose3D& pose);

/// Returns the scan in an observation, without number, label, time and movement. Supported are
/// CObservation3DRangeScan (range image, otherwise points), CObservationPointCloud and
/// CObservationVelodyneScan. Returns an empty value for other classes. Throws all exceptions of
/// MRPT.
std::optional<RawlogScan> make_scan(const mrpt::obs::CObservation& observation);

}  // namespace skycap::missions::online
