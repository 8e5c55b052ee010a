/// GPS times of compressed points of format 1 and 3: four sequences of times, one of which goes on
/// by a multiple of its last step (LAZ specification 1.4, section 8.2). Times are the bits of
/// doubles, read as integers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "geometry/io/las/integer_decoder.h"

namespace skycap::geometry::las {

class TimeDecoder {
 public:
  void begin(std::uint64_t first);

  std::uint64_t read(ArithmeticDecoder& decoder);

 private:
  struct Sequence {
    std::uint64_t time = 0;
    std::int32_t step = 0;
    int extremes = 0;  // how often the step was far off, one time after another
  };
  /// False: the time belongs to another sequence, which is now the current one.
  bool read_first_step(ArithmeticDecoder& decoder);
  bool read_multiple(ArithmeticDecoder& decoder);
  void follow(ArithmeticDecoder& decoder, int multiple);
  void begin_sequence(ArithmeticDecoder& decoder);
  void advance(Sequence& sequence, std::int32_t step) {
    sequence.time += static_cast<std::uint64_t>(static_cast<std::int64_t>(step));
  }

  std::array<Sequence, 4> sequences_;
  std::size_t current_ = 0, newest_ = 0;
  SymbolModel multiples_{516}, first_steps_{6};
  IntegerDecoder steps_{32, 9};
};

}  // namespace skycap::geometry::las
