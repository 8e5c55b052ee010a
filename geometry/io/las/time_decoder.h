/// Decoder of GPS times of the point formats 1 and 3. One of four time sequences continues by a
/// multiple of its previous step (LAZ specification 1.4, section 8.2). Times are the bits of
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
    int extremes = 0;  // consecutive steps outside the range of multiples
  };
  /// Returns false if the time belongs to another sequence, which then becomes the current one.
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
