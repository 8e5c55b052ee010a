/// Decoder of integers close to a prediction. The magnitude of the correction is coded as a symbol,
/// followed by its value (LAZ specification 1.4, section 6).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/io/las/arithmetic_decoder.h"

namespace skycap::geometry::las {

class IntegerDecoder {
 public:
  /// `bits` is 8, 16 or 32. Each context has its own model of the magnitude.
  IntegerDecoder(std::uint32_t bits, std::size_t contexts);

  void reset();

  /// Reads an integer modulo 2^bits. For 32 bits, this is a two's complement number.
  std::uint32_t read(ArithmeticDecoder& decoder, std::uint32_t prediction, std::size_t context = 0);
  std::int32_t read_signed(ArithmeticDecoder& decoder, std::int32_t prediction,
                           std::size_t context = 0) {
    return static_cast<std::int32_t>(
        read(decoder, static_cast<std::uint32_t>(prediction), context));
  }

  /// Returns the number of bits of the most recent correction.
  std::uint32_t magnitude() const { return magnitude_; }

 private:
  std::uint32_t correction(ArithmeticDecoder& decoder);

  std::uint32_t mask_, magnitude_ = 0;
  std::vector<SymbolModel> magnitudes_;   // by context
  BitModel bit_;                          // corrections 0 and 1
  std::vector<SymbolModel> corrections_;  // by magnitude
};

}  // namespace skycap::geometry::las
