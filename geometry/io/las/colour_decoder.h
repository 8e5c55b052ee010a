/// Colour decoder for all item versions. Bytes are predicted from the previous colour, green and
/// blue also from the change of red.
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
  SymbolModel changed_{128};            // mask of changed bytes; bit 6: channels differ
  std::array<SymbolModel, 6> changes_;  // low and high byte of red, green and blue
};

}  // namespace skycap::geometry::las
