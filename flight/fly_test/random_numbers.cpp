#include "flight/fly_test/random_numbers.h"

#include <cmath>
#include <numbers>

#include "geometry/split_mix.h"

namespace skycap::flight {
RandomNumbers::RandomNumbers(std::uint64_t seed, std::uint64_t stream)
    : engine_(geometry::split_mix(geometry::split_mix(seed) ^ stream)) {}

double RandomNumbers::uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

// Box and Muller 1958.
double RandomNumbers::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

}  // namespace skycap::flight
