#include "geometry/io/las/integer_decoder.h"

#include <algorithm>

namespace skycap::geometry::las {
namespace {

constexpr std::uint32_t modelled_bits =
    8;  // high bits of a correction with a model; the others are uncompressed

}  // namespace

IntegerDecoder::IntegerDecoder(std::uint32_t bits, std::size_t contexts)
    : mask_(bits == 32 ? 0xFFFFFFFF : (1U << bits) - 1),
      magnitudes_(contexts, SymbolModel(bits + 1)) {
  for (std::uint32_t magnitude = 0; magnitude <= bits; ++magnitude) {
    corrections_.emplace_back(1U << std::clamp(magnitude, 1U, modelled_bits));
  }
}

void IntegerDecoder::reset() {
  for (SymbolModel& model : magnitudes_) model.reset();
  for (SymbolModel& model : corrections_) model.reset();
  bit_.reset();
}

std::uint32_t IntegerDecoder::read(ArithmeticDecoder& decoder, std::uint32_t prediction,
                                   std::size_t context) {
  magnitude_ = decoder.symbol(magnitudes_[context]);
  return (prediction + correction(decoder)) & mask_;
}

/// Magnitude k > 0 represents -(2^k - 1) to -2^(k-1) and 2^(k-1) + 1 to 2^k; magnitude 0 represents
/// 0 and 1.
std::uint32_t IntegerDecoder::correction(ArithmeticDecoder& decoder) {
  if (magnitude_ == 0) return decoder.bit(bit_) ? 1 : 0;
  if (magnitude_ == 32) return 0x80000000;
  std::uint32_t value = decoder.symbol(corrections_[magnitude_]);
  if (magnitude_ > modelled_bits) {
    const std::uint32_t plain = magnitude_ - modelled_bits;
    value = value << plain | decoder.bits(plain);
  }
  const bool is_positive = value >> (magnitude_ - 1) != 0;
  return is_positive ? value + 1 : value - ((1U << magnitude_) - 1);
}

}  // namespace skycap::geometry::las
