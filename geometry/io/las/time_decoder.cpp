#include "geometry/io/las/time_decoder.h"

namespace skycap::geometry::las {
namespace {

// Symbols of multiples: 0 to 500 for the same multiple, then -1 to -10, then the following.
constexpr int largest_multiple = 500, smallest_multiple = -10;
constexpr int unchanged = largest_multiple - smallest_multiple + 1, new_sequence = unchanged + 1;

/// Returns the model for correcting a step that is `multiple` times the last step.
std::size_t find_context(int multiple) {
  if (multiple == 0) return 7;
  if (multiple == 1) return 1;
  if (multiple == largest_multiple) return 4;
  if (multiple == smallest_multiple) return 6;
  if (multiple < 0) return 5;
  return multiple < 10 ? 2 : 3;
}

}  // namespace

void TimeDecoder::begin(std::uint64_t first) {
  sequences_ = {};
  sequences_[0].time = first;
  current_ = newest_ = 0;
  multiples_.reset();
  first_steps_.reset();
  steps_.reset();
}

std::uint64_t TimeDecoder::read(ArithmeticDecoder& decoder) {
  // Encoders change the sequence at most once per time.
  for (int changes = 0; changes < 2; ++changes) {
    const bool is_first = sequences_[current_].step == 0;
    if (is_first ? read_first_step(decoder) : read_multiple(decoder)) {
      return sequences_[current_].time;
    }
  }
  throw_bad_file("has damaged compressed points: a timestamp does not belong to any sequence");
}

bool TimeDecoder::read_first_step(ArithmeticDecoder& decoder) {
  const std::uint32_t symbol = decoder.symbol(first_steps_);
  Sequence& sequence = sequences_[current_];
  if (symbol == 1) {
    sequence.step = steps_.read_signed(decoder, 0, 0);
    sequence.extremes = 0;
    advance(sequence, sequence.step);
  }
  if (symbol == 2) begin_sequence(decoder);
  if (symbol > 2) current_ = (current_ + symbol - 2) % 4;
  return symbol <= 2;
}

bool TimeDecoder::read_multiple(ArithmeticDecoder& decoder) {
  const int symbol = static_cast<int>(decoder.symbol(multiples_));
  if (symbol > new_sequence) {
    current_ = (current_ + static_cast<std::size_t>(symbol - new_sequence)) % 4;
    return false;
  }
  if (symbol == new_sequence) begin_sequence(decoder);
  if (symbol < unchanged) {
    follow(decoder, symbol <= largest_multiple ? symbol : largest_multiple - symbol);
  }
  return true;
}

void TimeDecoder::follow(ArithmeticDecoder& decoder, int multiple) {
  Sequence& sequence = sequences_[current_];
  const auto predicted =
      static_cast<std::uint32_t>(multiple) * static_cast<std::uint32_t>(sequence.step);
  const std::int32_t step =
      steps_.read_signed(decoder, static_cast<std::int32_t>(predicted), find_context(multiple));
  const bool is_extreme =
      multiple == 0 || multiple == largest_multiple || multiple == smallest_multiple;
  if (multiple == 1) {
    sequence.extremes = 0;
  } else if (is_extreme && ++sequence.extremes > 3) {
    sequence.step = step;
    sequence.extremes = 0;
  }
  advance(sequence, step);
}

void TimeDecoder::begin_sequence(ArithmeticDecoder& decoder) {
  const auto last_high = static_cast<std::uint32_t>(sequences_[current_].time >> 32);
  const std::uint64_t high = steps_.read(decoder, last_high, 8);
  current_ = newest_ = (newest_ + 1) % 4;
  sequences_[current_] = {.time = high << 32 | decoder.bits(32), .step = 0, .extremes = 0};
}

}  // namespace skycap::geometry::las
