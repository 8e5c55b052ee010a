/// Exact summation, independent of the order of the summands and of the division into partial sums.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace skycap::missions::evaluation {

/// Sum of up to 2^62 finite, non-negative numbers. Only value() rounds.
class ExactSum {
 public:
  /// Number of base-2^32 digits of the sum. The lowest digit has the weight 2^-1074.
  static constexpr std::size_t digits = 69;
  using Digits = std::array<std::uint64_t, digits>;

  ExactSum() = default;
  /// Restores a sum from all_digits().
  explicit ExactSum(const Digits& sum) : digits_(sum) {}

  void add(double number);
  void add(const ExactSum& more);

  /// Returns the sum with an error of at most one unit in the last place.
  double value() const;

  /// Returns the normalised digits, each below 2^32. Equal sums have equal digits.
  Digits all_digits() const;

 private:
  static void carry(Digits& sum);

  Digits digits_{};                      ///< each below 2^63
  std::uint32_t pending_additions_ = 0;  ///< additions since the last carry()
};

}  // namespace skycap::missions::evaluation
