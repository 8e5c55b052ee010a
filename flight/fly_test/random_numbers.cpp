#include "flight/fly_test/random_numbers.h"

#include <cmath>
#include <numbers>

namespace skycap::flight {
namespace {

/// Steele, Lea & Flood, Fast Splittable Pseudorandom Number Generators, 2014.
std::uint64_t split_mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

}  // namespace

RandomNumbers::RandomNumbers(std::uint64_t seed, std::uint64_t stream)
    : engine_(split_mix(split_mix(seed) ^ stream)) {}

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
