/// preview.ply: of a scan so many points as people can look at, which the page of the scan shows.
///
/// Binary PLY: x y z as float, in the mission's frame as the carrier believes itself to be, and
/// view as uint: the piece of the flight that a point is from, or the image. Which shots and pixels
/// are chosen follows from their times and numbers alone.
#pragma once

#include <cstdint>
#include <memory>

#include "missions/scan/cloud_file.h"
#include "sim/sensors/lidar.h"
#include "sim/sensors/trajectory.h"

namespace skycap::missions::scan {

inline constexpr const char* preview_name = "preview.ply";

/// Of so many shots or pixels, the share that is chosen: all, or about a million and a half, of
/// which many have no return.
double preview_share(double shots);

/// Whether it is one of the chosen, of which there are about a share; evenly spread, whatever the
/// regularity of the numbers.
bool is_previewed(std::uint64_t time, std::uint64_t number, double share);

/// The pieces of a laser scanner's flight.
struct PreviewPieces {
  double start = 0.0;   ///< of the first one [s]
  double length = 1.0;  ///< of each: whole turns of the scanner, or tenths of a second [s]
};

/// At most a thousand pieces.
PreviewPieces preview_pieces(const sim::LidarConfig& sensor, const sim::Trajectory& flown);

/// Points farther from the origin than single precision reaches are left out.
std::shared_ptr<const CloudFormat> preview_format(const PreviewPieces& pieces, double share);

}  // namespace skycap::missions::scan
