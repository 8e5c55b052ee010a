/// A sum that does not depend on the order of what is added, nor on who has added which part of it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace skycap::missions::evaluation {

/// Of finite numbers that are not negative; no rounding is done before value(). Holds up to 2^62
/// of them.
class ExactSum {
 public:
  /// Digits of the sum to the base 2^32, the lowest counting 2^-1074s.
  static constexpr std::size_t digits = 69;
  using Digits = std::array<std::uint64_t, digits>;

  ExactSum() = default;
  /// That of which these are the digits().
  explicit ExactSum(const Digits& sum) : digits_(sum) {}

  void add(double number);
  void add(const ExactSum& more);

  /// The sum, right to the last digit or the one before.
  double value() const;

  /// Each below 2^32: equal sums have equal ones.
  Digits all_digits() const;

 private:
  static void carry(Digits& sum);

  Digits digits_{};                ///< each below 2^63
  std::uint32_t not_carried_ = 0;  ///< additions since carry()
};

}  // namespace skycap::missions::evaluation
