/// Semantics of heights and surfaces in prior data.
#pragma once

#include <cstdint>

namespace skycap::missions::site_data {

/// Vertical datum of the heights in a file.
enum class HeightDatum {
  ellipsoid,  ///< WGS84 ellipsoid.
  geoid,      ///< The file's geoid if PROJ has its grid, otherwise EGM96 with a note.
  takeoff,    ///< The take-off pad.
};

/// Surface type according to the file.
enum class SurfaceKind : std::uint8_t { unknown, wall, roof, ground, opening, other };

}  // namespace skycap::missions::site_data
