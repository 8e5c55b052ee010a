/// What surfaces do to the light that a sensor sends out.
#pragma once

#include <cstdint>

namespace skycap::sim {

enum class Surface : std::uint8_t {
  matt,   ///< some of it comes back
  glass,  ///< none of it comes back, whatever is behind
  mirror  ///< it goes on as mirrored; what comes back then seems to lie straight on
};

}  // namespace skycap::sim
