/// Sanitises terminal output. Names and text from external files may contain terminal control
/// sequences.
#pragma once

#include <streambuf>
#include <string>

namespace skycap::missions::cli {

/// Converts text to a single line. Each control character, including line feeds and UTF-8 encoded
/// C1 controls, is replaced by a space. Text longer than 2000 bytes is shortened in the middle.
std::string printable_line(std::string text);

/// Forwards output to another buffer and replaces control characters, except line feeds and tabs,
/// by spaces. Write errors of the target buffer are propagated.
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
