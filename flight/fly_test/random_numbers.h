/// Random numbers of a flight, the same with every compiler: the standard prescribes the engine's,
/// not those of its distributions.
#pragma once

#include <cstdint>
#include <random>

namespace skycap::flight {

class RandomNumbers {
 public:
  /// Sequences of different seeds or streams are unrelated.
  RandomNumbers(std::uint64_t seed, std::uint64_t stream);

  /// In [0, 1).
  double uniform();
  /// In [least, most).
  double between(double least, double most) { return least + (most - least) * uniform(); }
  /// Of mean 0 and standard deviation 1.
  double normal();

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace skycap::flight
