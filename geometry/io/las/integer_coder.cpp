#include "geometry/io/las/integer_coder.h"

#include <algorithm>

namespace skycap::geometry::las {
IntegerCoder::IntegerCoder(std::uint32_t bits, std::size_t contexts)
    : bits_(bits),
      mask_(bits == 32 ? 0xFFFFFFFF : (1U << bits) - 1),
      magnitudes_(contexts, SymbolModel(bits + 1)) {
  for (std::uint32_t magnitude = 0; magnitude <= bits; ++magnitude) {
    corrections_.emplace_back(1U << std::clamp(magnitude, 1U, modelled_bits));
  }
}

void IntegerCoder::reset() {
  for (SymbolModel& model : magnitudes_) model.reset();
  for (SymbolModel& model : corrections_) model.reset();
  bit_.reset();
}

}  // namespace skycap::geometry::las
