/// Whole numbers near to a prediction: the correction's magnitude as a symbol, then its value (LAZ
/// specification 1.4, section 6).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/io/las/arithmetic_decoder.h"

namespace skycap::geometry::las {

class IntegerDecoder {
 public:
  /// Numbers of 8, 16 or 32 bits. Each context has a model of its own for the magnitude.
  IntegerDecoder(std::uint32_t bits, std::size_t contexts);

  void reset();

  /// Modulo 2^bits; with 32 bits a two's complement.
  std::uint32_t read(ArithmeticDecoder& decoder, std::uint32_t prediction, std::size_t context = 0);
  std::int32_t read_signed(ArithmeticDecoder& decoder, std::int32_t prediction,
                           std::size_t context = 0) {
    return static_cast<std::int32_t>(
        read(decoder, static_cast<std::uint32_t>(prediction), context));
  }

  /// Bits of the correction that was read last.
  std::uint32_t magnitude() const { return magnitude_; }

 private:
  std::uint32_t correction(ArithmeticDecoder& decoder);

  std::uint32_t mask_, magnitude_ = 0;
  std::vector<SymbolModel> magnitudes_;   // of each context
  BitModel bit_;                          // of corrections 0 and 1
  std::vector<SymbolModel> corrections_;  // of each magnitude
};

}  // namespace skycap::geometry::las
