/// Colours of compressed points, of all versions: byte by byte against the last colour, green and
/// blue also by how much red has changed.
#pragma once

#include <array>
#include <cstdint>

#include "geometry/io/las/arithmetic_decoder.h"

namespace skycap::geometry::las {

using Colour = std::array<std::uint16_t, 3>;  ///< red, green, blue

class ColourDecoder {
 public:
  void reset() {
    changed_.reset();
    for (SymbolModel& model : changes_) model.reset();
  }

  Colour read(ArithmeticDecoder& decoder, const Colour& last);

 private:
  SymbolModel changed_{128};            // which bytes; bit 6: not all channels are the same
  std::array<SymbolModel, 6> changes_;  // low byte, high byte of red; so green, blue
};

}  // namespace skycap::geometry::las
