#include "geometry/io/las/time_coder.h"

#include <algorithm>

namespace skycap::geometry::las {
namespace {

// Symbols of multiples: 0 to 500 for the same multiple, then -1 to -10, then the following.
constexpr int largest_multiple = 500, smallest_multiple = -10;
constexpr int end_of_multiples = largest_multiple - smallest_multiple + 1;

/// Returns the model for correcting a step that is `multiple` times the last step.
std::size_t find_context(int multiple) {
  if (multiple == 0) return 7;
  if (multiple == 1) return 1;
  if (multiple == largest_multiple) return 4;
  if (multiple == smallest_multiple) return 6;
  if (multiple < 0) return 5;
  return multiple < 10 ? 2 : 3;
}

/// Returns the multiple of `last` that is closest to `step`, within the limits.
int find_multiple(std::int32_t step, std::int32_t last) {
  const float ratio =
      std::clamp(static_cast<float>(step) / static_cast<float>(last),
                 static_cast<float>(smallest_multiple), static_cast<float>(largest_multiple));
  return static_cast<int>(ratio >= 0.0F ? ratio + 0.5F : ratio - 0.5F);
}

}  // namespace

void TimeCoder::begin(std::uint64_t first) {
  sequences_ = {};
  sequences_[0].time = first;
  current_ = newest_ = 0;
  multiples_.reset();
  first_steps_.reset();
  steps_.reset();
}

template <typename Coder>
std::uint64_t TimeCoder::code(Coder& coder, std::uint64_t time) {
  // Encoders change the sequence at most once per time.
  for (int changes = 0; changes < 2; ++changes) {
    const bool is_first = sequences_[current_].step == 0;
    if (is_first ? code_first_step(coder, time) : code_multiple(coder, time)) {
      return sequences_[current_].time;
    }
  }
  throw_bad_file("has damaged compressed points: a timestamp does not belong to any sequence");
}

std::optional<std::int32_t> TimeCoder::find_step(std::size_t sequence, std::uint64_t time) const {
  const auto difference = static_cast<std::int64_t>(time - sequences_[sequence].time);
  const auto step = static_cast<std::int32_t>(difference);
  return step == difference ? std::optional(step) : std::nullopt;
}

std::size_t TimeCoder::find_sequence(std::uint64_t time) const {
  for (std::size_t after = 1; after < sequences_.size(); ++after) {
    if (find_step((current_ + after) % 4, time)) return after;
  }
  return 0;
}

template <typename Coder>
bool TimeCoder::code_first_step(Coder& coder, std::uint64_t time) {
  std::uint32_t symbol = 0;
  std::int32_t step = 0;
  if constexpr (Coder::encodes) {
    const auto found = find_step(current_, time);
    step = found.value_or(0);
    const std::size_t other = found ? 0 : find_sequence(time);
    symbol = unchanged_ + (found ? 0 : static_cast<std::uint32_t>(other) + 1);
  }
  symbol = coder.symbol(first_steps_, symbol);
  Sequence& sequence = sequences_[current_];
  const std::uint32_t new_sequence = unchanged_ + 1;
  if (symbol == unchanged_) {
    sequence.step = steps_.code_signed(coder, 0, step, 0);
    sequence.extremes = 0;
    advance(sequence, sequence.step);
  }
  if (symbol == new_sequence) begin_sequence(coder, time);
  if (symbol > new_sequence) current_ = (current_ + symbol - new_sequence) % 4;
  return symbol <= new_sequence;
}

template <typename Coder>
bool TimeCoder::code_multiple(Coder& coder, std::uint64_t time) {
  const int new_sequence = end_of_multiples + static_cast<int>(unchanged_);
  int symbol = 0;
  std::int32_t step = 0;
  if constexpr (Coder::encodes) {
    if (const auto found = find_step(current_, time)) {
      step = *found;
      const int multiple = find_multiple(step, sequences_[current_].step);
      symbol = multiple >= 0 ? multiple : largest_multiple - multiple;
    } else {
      symbol = new_sequence + static_cast<int>(find_sequence(time));
    }
  }
  symbol = static_cast<int>(coder.symbol(multiples_, static_cast<std::uint32_t>(symbol)));
  if (symbol > new_sequence) {
    current_ = (current_ + static_cast<std::size_t>(symbol - new_sequence)) % 4;
    return false;
  }
  if (symbol == new_sequence) begin_sequence(coder, time);
  if (symbol < end_of_multiples) {
    follow(coder, symbol <= largest_multiple ? symbol : largest_multiple - symbol, step);
  }
  return true;
}

template <typename Coder>
void TimeCoder::follow(Coder& coder, int multiple, std::int32_t value) {
  Sequence& sequence = sequences_[current_];
  const auto predicted =
      static_cast<std::uint32_t>(multiple) * static_cast<std::uint32_t>(sequence.step);
  const std::int32_t step = steps_.code_signed(coder, static_cast<std::int32_t>(predicted), value,
                                               find_context(multiple));
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

template <typename Coder>
void TimeCoder::begin_sequence(Coder& coder, std::uint64_t time) {
  const auto last_high = static_cast<std::uint32_t>(sequences_[current_].time >> 32);
  const std::uint64_t high =
      steps_.code(coder, last_high, static_cast<std::uint32_t>(time >> 32), 8);
  const std::uint32_t low = coder.bits(32, static_cast<std::uint32_t>(time));
  current_ = newest_ = (newest_ + 1) % 4;
  sequences_[current_] = {.time = high << 32 | low, .step = 0, .extremes = 0};
}

template std::uint64_t TimeCoder::code(ArithmeticDecoder& coder, std::uint64_t time);
template std::uint64_t TimeCoder::code(ArithmeticEncoder& coder, std::uint64_t time);

}  // namespace skycap::geometry::las
