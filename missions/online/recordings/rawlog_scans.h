/// Scans of MRPT's classes. For the module.
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

Eigen::Isometry3d isometry_of(const mrpt::poses::CPose3D& pose);

/// The scan in an observation, without number, label, time and movement: of CObservation3DRangeScan
/// the range image, or its points if it has none; CObservationPointCloud; CObservationVelodyneScan.
/// Nothing for other classes. May throw what MRPT throws.
std::optional<RawlogScan> scan_of(const mrpt::obs::CObservation& observation);

}  // namespace skycap::missions::online
