#include "geometry/io/las/arithmetic_coder.h"

#include <algorithm>
#include <utility>

namespace skycap::geometry::las {
namespace {

constexpr std::uint32_t max_count =
    1 << 15;  // maximum number of counted symbols, after which all counts are halved
constexpr std::uint32_t max_count_bits = 1 << 13;

[[noreturn]] void reject_value() {
  throw_bad_file("has damaged compressed points: their bytes cannot be decoded");
}

}  // namespace

void SymbolModel::begin(bool has_table) {
  if (counts_.empty()) {
    if (has_table && symbols_ > 16) {
      std::uint32_t bits = 3;
      while (symbols_ > 1U << (bits + 2)) ++bits;
      table_shift_ = 15 - bits;
      table_.resize((1U << bits) + 2);
    }
    counts_.resize(symbols_);
    distribution_.resize(symbols_);
  }
  std::ranges::fill(counts_, std::uint16_t{1});
  total_ = 0;
  cycle_ = symbols_;
  update();
  cycle_ = until_update_ = (symbols_ + 6) / 2;
}

void SymbolModel::update() {
  total_ += cycle_;
  if (total_ > max_count) {
    total_ = 0;
    for (std::uint16_t& count : counts_) {
      count = static_cast<std::uint16_t>((count + 1) / 2);
      total_ += count;
    }
  }
  const std::uint32_t scale = 0x80000000 / total_;
  std::uint32_t sum = 0;
  for (std::uint32_t symbol = 0; symbol < symbols_; ++symbol) {
    distribution_[symbol] = static_cast<std::uint16_t>(scale * sum >> 16);
    sum += counts_[symbol];
  }
  if (table_shift_ != 0) fill_table();
  cycle_ = std::min(cycle_ * 5 / 4, (symbols_ + 6) * 8);
  until_update_ = cycle_;
}

/// Each entry is the last symbol whose cumulative probability is below that of the entry.
void SymbolModel::fill_table() {
  std::size_t entry = 0;
  for (std::uint32_t symbol = 1; symbol < symbols_; ++symbol) {
    const std::size_t begin = distribution_[symbol] >> table_shift_;
    while (entry < begin) table_[++entry] = static_cast<std::uint16_t>(symbol - 1);
  }
  table_[0] = 0;
  while (entry + 1 < table_.size()) table_[++entry] = static_cast<std::uint16_t>(symbols_ - 1);
}

void BitModel::update() {
  total_ += cycle_;
  if (total_ > max_count_bits) {
    total_ = (total_ + 1) / 2;
    zeros_ = (zeros_ + 1) / 2;
    if (zeros_ == total_) ++total_;
  }
  zero_share_ = zeros_ * (0x80000000 / total_) >> 18;
  cycle_ = std::min(cycle_ * 5 / 4, 64U);
  until_update_ = cycle_;
}

ArithmeticDecoder::ArithmeticDecoder(ByteWindow bytes) : bytes_(std::move(bytes)) {
  for (int i = 0; i < 4; ++i) value_ = value_ << 8 | bytes_.next();
  if (value_ >= length_) reject_value();
}

std::uint32_t ArithmeticDecoder::bits(std::uint32_t count, std::uint32_t /*value*/) {
  if (count <= 19) return few_bits(count);
  const std::uint32_t low = few_bits(16);
  return few_bits(count - 16) << 16 | low;
}

std::uint32_t ArithmeticDecoder::few_bits(std::uint32_t count) {
  const std::uint32_t unit = length_ >> count;
  const std::uint32_t value = value_ / unit;
  if (value >> count != 0) reject_value();
  narrow(value * unit, unit);
  return value;
}

std::uint32_t ArithmeticEncoder::bits(std::uint32_t count, std::uint32_t value) {
  if (count <= 19) {
    few_bits(count, value);
  } else {
    few_bits(16, value & 0xFFFF);
    few_bits(count - 16, value >> 16);
  }
  return value;
}

void ArithmeticEncoder::few_bits(std::uint32_t count, std::uint32_t value) {
  const std::uint32_t unit = length_ >> count;
  narrow(value * unit, unit);
}

void ArithmeticEncoder::carry() {
  auto byte = bytes_.rbegin();
  for (; static_cast<std::uint8_t>(*byte) == 0xFF; ++byte) *byte = 0;
  ++*byte;
}

std::string ArithmeticEncoder::finish() {
  constexpr std::uint32_t min_length = 1 << 24;
  // The shortest number that identifies the interval, then zeros that decoders read in advance.
  const bool is_wide = length_ > 2 * min_length;
  if (is_wide) {
    narrow(min_length, min_length >> 1);
  } else {
    narrow(min_length >> 1, min_length >> 9);
  }
  bytes_.append(is_wide ? 3 : 2, '\0');
  std::string bytes;
  bytes.swap(bytes_);
  *this = {};
  return bytes;
}

}  // namespace skycap::geometry::las
