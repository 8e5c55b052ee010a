/// What reaches the terminal. Names and texts of foreign files may hold anything, also sequences
/// that a terminal obeys.
#pragma once

#include <streambuf>
#include <string>

namespace skycap::missions::cli {

/// The text as one line: each control character (also those of ISO 8859-1, in UTF-8) becomes a
/// space, ends of lines too, and what is longer than 2000 bytes loses its middle.
std::string printable_line(std::string text);

/// Passes text on to another buffer, control characters other than ends of lines and tabs as
/// spaces. Whoever writes through it learns when the other one fails.
class PrintableBuffer : public std::streambuf {
 public:
  explicit PrintableBuffer(std::streambuf& target) : target_(target) {}

 protected:
  int_type overflow(int_type character) override;
  int sync() override { return target_.pubsync(); }

 private:
  std::streambuf& target_;
  char before_ = 0;
};

}  // namespace skycap::missions::cli
