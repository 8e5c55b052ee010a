/// Coder of GPS times. One of four time sequences continues by a multiple of its previous step (LAZ
/// specification 1.4, sections 8.2 and 9.1). Times are the bits of doubles, coded as integers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "geometry/io/las/integer_coder.h"

namespace skycap::geometry::las {

class TimeCoder {
 public:
  /// Point formats 6 and above are layered. Their code has no symbol for an unchanged time.
  explicit TimeCoder(bool is_layered)
      : unchanged_(is_layered ? 0 : 1),
        multiples_(515U + unchanged_),
        first_steps_(5U + unchanged_) {}

  void begin(std::uint64_t first);

  /// Encoders must be layered.
  template <typename Coder>
  std::uint64_t code(Coder& coder, std::uint64_t time = 0);

 private:
  struct Sequence {
    std::uint64_t time = 0;
    std::int32_t step = 0;
    int extremes = 0;  // consecutive steps outside the range of multiples
  };
  /// Returns false if the time belongs to another sequence, which then becomes the current one.
  template <typename Coder>
  bool code_first_step(Coder& coder, std::uint64_t time);
  template <typename Coder>
  bool code_multiple(Coder& coder, std::uint64_t time);
  template <typename Coder>
  void follow(Coder& coder, int multiple, std::int32_t step);
  template <typename Coder>
  void begin_sequence(Coder& coder, std::uint64_t time);

  /// Returns the step from a sequence to `time` if it has 32 bits.
  std::optional<std::int32_t> find_step(std::size_t sequence, std::uint64_t time) const;
  /// Returns how many sequences after the current one continues to `time`, or 0 for none.
  std::size_t find_sequence(std::uint64_t time) const;
  void advance(Sequence& sequence, std::int32_t step) {
    sequence.time += static_cast<std::uint64_t>(static_cast<std::int64_t>(step));
  }

  std::array<Sequence, 4> sequences_;
  std::size_t current_ = 0, newest_ = 0;
  std::uint32_t unchanged_;  // number of symbols for an unchanged time
  SymbolModel multiples_, first_steps_;
  IntegerCoder steps_{32, 9};
};

}  // namespace skycap::geometry::las
