/// Coder of integers close to a prediction. The magnitude of the correction is coded as a symbol,
/// followed by its value (LAZ specification 1.4, section 6).
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/io/las/arithmetic_coder.h"

namespace skycap::geometry::las {

class IntegerCoder {
 public:
  /// `bits` is 8, 16 or 32. Each context has its own model of the magnitude.
  IntegerCoder(std::uint32_t bits, std::size_t contexts);

  void reset();

  /// Reads an integer modulo 2^bits. For 32 bits, this is a two's complement number.
  std::uint32_t read(ArithmeticDecoder& decoder, std::uint32_t prediction,
                     std::size_t context = 0) {
    return code(decoder, prediction, 0, context);
  }

  /// Reads or writes an integer modulo 2^bits.
  template <typename Coder>
  std::uint32_t code(Coder& coder, std::uint32_t prediction, std::uint32_t value,
                     std::size_t context = 0);

  template <typename Coder>
  std::int32_t code_signed(Coder& coder, std::int32_t prediction, std::int32_t value,
                           std::size_t context = 0) {
    return static_cast<std::int32_t>(code(coder, static_cast<std::uint32_t>(prediction),
                                          static_cast<std::uint32_t>(value), context));
  }

  /// Returns the number of bits of the most recent correction.
  std::uint32_t magnitude() const { return magnitude_; }

 private:
  /// High bits of a correction with a model; the others are uncompressed.
  static constexpr std::uint32_t modelled_bits = 8;

  /// Codes the correction of known magnitude.
  template <typename Coder>
  std::uint32_t code_correction(Coder& coder, std::uint32_t correction);

  std::uint32_t bits_, mask_, magnitude_ = 0;
  std::vector<SymbolModel> magnitudes_;   // by context
  BitModel bit_;                          // corrections 0 and 1
  std::vector<SymbolModel> corrections_;  // by magnitude
};

/// Magnitude k > 0 represents -(2^k - 1) to -2^(k-1) and 2^(k-1) + 1 to 2^k; magnitude 0 represents
/// 0 and 1.
template <typename Coder>
std::uint32_t IntegerCoder::code(Coder& coder, std::uint32_t prediction, std::uint32_t value,
                                 std::size_t context) {
  std::uint32_t correction = 0, magnitude = 0;
  if constexpr (Coder::encodes) {
    const std::uint32_t unused = 32 - bits_;
    const std::uint32_t difference = (value - prediction) << unused;
    correction = static_cast<std::uint32_t>(static_cast<std::int32_t>(difference) >> unused);
    const bool is_positive = static_cast<std::int32_t>(correction) > 0;
    magnitude =
        static_cast<std::uint32_t>(std::bit_width(is_positive ? correction - 1 : -correction));
  }
  magnitude_ = coder.symbol(magnitudes_[context], magnitude);
  return (prediction + code_correction(coder, correction)) & mask_;
}

template <typename Coder>
std::uint32_t IntegerCoder::code_correction(Coder& coder, std::uint32_t correction) {
  if (magnitude_ == 0) return coder.bit(bit_, correction != 0) ? 1 : 0;
  if (magnitude_ == 32) return 0x80000000;
  const std::uint32_t lowest = (1U << magnitude_) - 1;
  std::uint32_t value = 0;
  if constexpr (Coder::encodes) {
    const bool is_positive = static_cast<std::int32_t>(correction) > 0;
    value = is_positive ? correction - 1 : correction + lowest;
  }
  if (magnitude_ > modelled_bits) {
    const std::uint32_t plain = magnitude_ - modelled_bits;
    const std::uint32_t high = coder.symbol(corrections_[magnitude_], value >> plain);
    value = high << plain | coder.bits(plain, value & ((1U << plain) - 1));
  } else {
    value = coder.symbol(corrections_[magnitude_], value);
  }
  return value >> (magnitude_ - 1) != 0 ? value + 1 : value - lowest;
}

}  // namespace skycap::geometry::las
