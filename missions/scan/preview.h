/// preview.ply: a subset of a scan's points for display in the HTML report.
///
/// Binary PLY with x y z as float, in the mission frame by the estimated trajectory, and view as
/// uint: the piece of the flight or the image that contains the point. The selection depends only
/// on the times and numbers of pulses and pixels.
#pragma once

#include <cstdint>
#include <memory>

#include "missions/scan/cloud_file.h"
#include "sim/sensors/lidar.h"
#include "sim/sensors/trajectory.h"

namespace skycap::missions::scan {

inline constexpr const char* preview_name = "preview.ply";

/// Returns the fraction of pulses or pixels to select: all, or about 1.5 million, many of which
/// have no return.
double preview_share(double pulses);

/// Returns true for a pseudo-random, evenly distributed subset that contains the fraction `share`
/// of all pulses or pixels.
bool is_previewed(std::uint64_t time, std::uint64_t number, double share);

/// Equal pieces of a laser scanner's flight.
struct PreviewSegments {
  double start = 0.0;  ///< Start of the first piece [s].
  /// Length of each piece: complete revolutions of the scanner, or multiples of 0.1 s [s].
  double length = 1.0;
};

/// Divides the flight into at most one thousand pieces.
PreviewSegments make_preview_segments(const sim::LidarConfig& sensor,
                                      const sim::Trajectory& ground_truth);

/// Returns the preview format. Points with coordinates above geometry::farthest_single_coordinate
/// are skipped.
std::shared_ptr<const CloudFormat> preview_format(const PreviewSegments& segments, double share);

}  // namespace skycap::missions::scan
