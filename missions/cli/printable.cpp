#include "missions/cli/printable.h"

namespace skycap::missions::cli {
namespace {

/// Returns whether a character is a control character. Terminals also interpret U+0080 to U+009F,
/// which UTF-8 encodes as C2 followed by the code.
bool is_control(char before, char character) {
  const auto code = static_cast<unsigned char>(character);
  if (code < 0x20 || code == 0x7F) return true;
  return static_cast<unsigned char>(before) == 0xC2 && code >= 0x80 && code < 0xA0;
}

bool is_continuation(char character) {
  return (static_cast<unsigned char>(character) & 0xC0) == 0x80;
}

}  // namespace

std::string printable_line(std::string text) {
  constexpr std::size_t longest = 2000, head = 1400, tail = 500;
  if (text.size() > longest) {
    std::size_t end = head, begin = text.size() - tail;  // does not split a multi-byte character
    while (is_continuation(text[end])) --end;
    while (begin < text.size() && is_continuation(text[begin])) ++begin;
    text = text.substr(0, end) + " ... " + text.substr(begin);
  }
  while (!text.empty() && text.back() == '\n') text.pop_back();
  char before = 0;
  for (char& character : text) {
    const char original = character;
    if (is_control(before, character)) character = ' ';
    before = original;
  }
  return text;
}

PrintableBuffer::int_type PrintableBuffer::overflow(int_type character) {
  if (traits_type::eq_int_type(character, traits_type::eof())) return traits_type::not_eof(0);
  const char original = traits_type::to_char_type(character);
  const bool is_kept = original == '\n' || original == '\t' || !is_control(before_, original);
  before_ = original;
  return target_.sputc(is_kept ? original : ' ');
}

}  // namespace skycap::missions::cli
