/// Surface types by their effect on the light of a sensor.
#pragma once

#include <cstdint>

namespace skycap::sim {

enum class Surface : std::uint8_t {
  matt,   ///< Diffuse reflection with a return.
  glass,  ///< No return, neither from the glass nor from objects behind it.
  mirror  ///< Specular reflection. Mirrored objects appear in a straight line behind the surface.
};

}  // namespace skycap::sim
