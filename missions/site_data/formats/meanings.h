/// What numbers and surfaces of files of prior data mean.
#pragma once

#include <cstdint>

namespace skycap::missions::site_data {

/// What heights of a file count from.
enum class HeightDatum {
  ellipsoid,  ///< WGS84's
  geoid,      ///< the file's own if PROJ has its grid, else EGM96, with a note
  takeoff,    ///< the pad
};

/// What a file says that a surface is.
enum class SurfaceKind : std::uint8_t { unknown, wall, roof, ground, opening, other };

}  // namespace skycap::missions::site_data
