/// Adaptive arithmetic coder, the entropy coder of LAZ (A. Said, Introduction to Arithmetic Coding,
/// HP Laboratories 2004; LAZ specification 1.4, section 5). Decoder and encoder share the models
/// and have the same functions, so that an attribute of a point is coded by one function for both:
/// the decoder ignores the passed value and returns the decoded one, the encoder returns the passed
/// one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/io/las/byte_window.h"

namespace skycap::geometry::las {

/// Adaptive probability model of the symbols of an alphabet. Memory is allocated on first use.
class SymbolModel {
 public:
  /// `symbols` must be in [2, 2048].
  explicit SymbolModel(std::uint32_t symbols = 256) : symbols_(symbols) {}

  /// Resets the model to equal probabilities.
  void reset() { until_update_ = 0; }

 private:
  friend class ArithmeticDecoder;
  friend class ArithmeticEncoder;
  void begin(bool has_table);
  void update();
  void fill_table();

  std::uint32_t symbols_, until_update_ = 0, cycle_ = 0, total_ = 0;
  std::uint32_t table_shift_ = 0;      ///< 0 without a table: for small alphabets and encoders
  std::vector<std::uint16_t> counts_;  ///< number of occurrences per symbol
  std::vector<std::uint16_t>
      distribution_;  ///< cumulative probability before each symbol, scaled to 2^15
  std::vector<std::uint16_t>
      table_;  ///< first candidate symbol by the leading bits of the cumulative probability
};

/// Adaptive probability model of a bit.
class BitModel {
 public:
  void reset() { *this = {}; }

 private:
  friend class ArithmeticDecoder;
  friend class ArithmeticEncoder;
  void update();

  std::uint32_t zeros_ = 1, total_ = 2,
                zero_share_ = 1 << 12;  ///< probability of zero, scaled to 2^13
  std::uint32_t cycle_ = 4, until_update_ = 4;
};

/// All member functions throw Error{bad_file} if the data ends or is not a valid encoding.
class ArithmeticDecoder {
 public:
  static constexpr bool encodes = false;

  ArithmeticDecoder() = default;  ///< without data; must not be used for decoding
  explicit ArithmeticDecoder(ByteWindow bytes);

  std::uint32_t symbol(SymbolModel& model, std::uint32_t /*value*/ = 0);
  bool bit(BitModel& model, bool /*value*/ = false);

  /// Reads a number of `count` (at most 32) equally distributed bits.
  std::uint32_t bits(std::uint32_t count, std::uint32_t /*value*/ = 0);

 private:
  std::uint32_t few_bits(std::uint32_t count);
  void narrow(std::uint32_t low, std::uint32_t length);

  ByteWindow bytes_;
  std::uint32_t value_ = 0, length_ = 0xFFFFFFFF;  // invariant: value_ < length_
};

/// Encoder whose bytes ArithmeticDecoder decodes to the same values.
class ArithmeticEncoder {
 public:
  static constexpr bool encodes = true;

  std::uint32_t symbol(SymbolModel& model, std::uint32_t value);
  bool bit(BitModel& model, bool value);

  /// Writes the lowest `count` (at most 32) bits of `value`, which must not have others.
  std::uint32_t bits(std::uint32_t count, std::uint32_t value);

  /// Returns all bytes and begins the next encoding.
  std::string finish();

 private:
  void narrow(std::uint32_t low, std::uint32_t length);
  void few_bits(std::uint32_t count, std::uint32_t value);
  void carry();

  std::string bytes_;
  std::uint32_t base_ = 0, length_ = 0xFFFFFFFF;
};

inline void ArithmeticDecoder::narrow(std::uint32_t low, std::uint32_t length) {
  constexpr std::uint32_t min_length = 1 << 24;
  value_ -= low;
  length_ = length;
  while (length_ < min_length) {
    value_ = value_ << 8 | bytes_.next();
    length_ <<= 8;
  }
}

inline std::uint32_t ArithmeticDecoder::symbol(SymbolModel& model, std::uint32_t /*value*/) {
  if (model.until_update_ == 0) model.begin(true);
  const std::uint16_t* const shares = model.distribution_.data();
  const std::uint32_t unit = length_ >> 15;
  std::uint32_t symbol = 0, end = model.symbols_;
  if (model.table_shift_ != 0) {
    const std::uint32_t share = value_ / unit, entry = share >> model.table_shift_;
    symbol = model.table_[entry];
    end = model.table_[entry + 1] + 1U;
    while (end - symbol > 1) {
      const std::uint32_t middle = (symbol + end) / 2;
      (shares[middle] > share ? end : symbol) = middle;
    }
  } else {
    while (end - symbol > 1) {
      const std::uint32_t middle = (symbol + end) / 2;
      (unit * shares[middle] > value_ ? end : symbol) = middle;
    }
  }
  const std::uint32_t low = unit * shares[symbol];
  narrow(low, (end == model.symbols_ ? length_ : unit * shares[end]) - low);
  ++model.counts_[symbol];
  if (--model.until_update_ == 0) model.update();
  return symbol;
}

inline bool ArithmeticDecoder::bit(BitModel& model, bool /*value*/) {
  const std::uint32_t zeros = model.zero_share_ * (length_ >> 13);
  const bool is_one = value_ >= zeros;
  if (!is_one) ++model.zeros_;
  if (is_one) {
    narrow(zeros, length_ - zeros);
  } else {
    narrow(0, zeros);
  }
  if (--model.until_update_ == 0) model.update();
  return is_one;
}

inline void ArithmeticEncoder::narrow(std::uint32_t low, std::uint32_t length) {
  constexpr std::uint32_t min_length = 1 << 24;
  base_ += low;
  if (base_ < low) carry();
  length_ = length;
  while (length_ < min_length) {
    bytes_.push_back(static_cast<char>(base_ >> 24));
    base_ <<= 8;
    length_ <<= 8;
  }
}

inline std::uint32_t ArithmeticEncoder::symbol(SymbolModel& model, std::uint32_t value) {
  if (model.until_update_ == 0) model.begin(false);
  const std::uint16_t* const shares = model.distribution_.data();
  const std::uint32_t unit = length_ >> 15, low = unit * shares[value];
  narrow(low, (value + 1 == model.symbols_ ? length_ : unit * shares[value + 1]) - low);
  ++model.counts_[value];
  if (--model.until_update_ == 0) model.update();
  return value;
}

inline bool ArithmeticEncoder::bit(BitModel& model, bool value) {
  const std::uint32_t zeros = model.zero_share_ * (length_ >> 13);
  if (value) {
    narrow(zeros, length_ - zeros);
  } else {
    ++model.zeros_;
    narrow(0, zeros);
  }
  if (--model.until_update_ == 0) model.update();
  return value;
}

}  // namespace skycap::geometry::las
