/// Colour coder for all item versions. Bytes are predicted from the previous colour, green and blue
/// also from the change of red.
#pragma once

#include <array>
#include <cstdint>

#include "geometry/io/las/arithmetic_coder.h"

namespace skycap::geometry::las {

using Colour = std::array<std::uint16_t, 3>;  ///< red, green, blue

class ColourCoder {
 public:
  void reset() {
    changed_.reset();
    for (SymbolModel& model : changes_) model.reset();
  }

  template <typename Coder>
  Colour code(Coder& coder, const Colour& last, const Colour& value = {});

 private:
  SymbolModel changed_{128};            // mask of changed bytes; bit 6: channels differ
  std::array<SymbolModel, 6> changes_;  // low and high byte of red, green and blue
};

}  // namespace skycap::geometry::las
