/// Tokeniser of text files for readers. Tracks the line number for messages. A leading UTF-8
/// byte-order mark is skipped. Lines end with \n, \r\n or \r.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "geometry/error.h"
#include "geometry/io/text/plain_text.h"

namespace skycap::geometry {

class TextScanner {
 public:
  /// Every message begins with `name`, usually a path. `name` and `text` must outlive the scanner.
  TextScanner(std::string_view name, std::string_view text, std::size_t first_line = 1)
      : name_(name), text_(text), line_(first_line) {
    if (first_line == 1) at_ = text.size() - without_mark(text).size();
  }

  std::size_t line() const { return line_; }
  std::size_t remaining() const { return text_.size() - at_; }

  /// Returns the next word on this line or a later one, or nullopt at the end of the text.
  std::optional<std::string_view> word() {
    while (true) {
      if (const auto found = word_in_line()) return found;
      if (!next_line()) return std::nullopt;
    }
  }

  /// Returns the next word on this line, or nullopt at its end.
  std::optional<std::string_view> word_in_line() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_]) && !is_line_end(text_[at_])) ++at_;
    if (at_ == begin) return std::nullopt;
    return text_.substr(begin, at_ - begin);
  }

  /// Returns the rest of this line without surrounding blanks.
  std::string_view remaining_line() {
    const std::size_t begin = at_;
    at_ = end_of_line();
    return trimmed(text_.substr(begin, at_ - begin));
  }

  /// Advances to the start of the next line. Returns false at the end of the text.
  bool next_line() {
    const std::size_t end = end_of_line();
    at_ = end;
    if (end == text_.size()) return false;
    at_ += text_.substr(end).starts_with("\r\n") ? 2 : 1;
    ++line_;
    return at_ < text_.size();
  }

  /// Converts `word` to a number. `what` names it in the message, such as "a coordinate". Real
  /// numbers may be NaN or infinite.
  template <typename Number>
  Number number(std::optional<std::string_view> word, std::string_view what) const {
    if (!word) fail("ends where " + std::string(what) + " is expected");
    if constexpr (std::is_floating_point_v<Number>) {
      if (const auto value = number_in(*word)) return static_cast<Number>(*value);
    } else {
      std::string_view digits = *word;
      if (digits.starts_with('+')) digits.remove_prefix(1);
      Number value{};
      const auto [end, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (error == std::errc() && end == digits.data() + digits.size()) return value;
    }
    fail_on_word(*word, what);
  }

  /// Throws an Error about an unexpected word.
  [[noreturn]] void fail_on_word(std::string_view word, std::string_view what) const {
    const std::string quoted = "'" + excerpt(word) + "'";
    if (has_decimal_comma(word)) {
      fail(quoted + " has a decimal comma; use decimal points");
    }
    fail("expected " + std::string(what) + ", found " + quoted);
  }

  [[noreturn]] void fail(const std::string& what) const { fail_at(line_, what); }
  [[noreturn]] void fail_at(std::size_t line, const std::string& what) const {
    throw Error(ErrorKind::bad_file,
                std::string(name_) + ": line " + std::to_string(line) + ": " + what);
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }
  static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
  /// Returns the position of the end of the line or text.
  std::size_t end_of_line() const {
    std::size_t end = at_;
    while (end < text_.size() && !is_line_end(text_[end])) ++end;
    return end;
  }

  std::string_view name_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_;
};

}  // namespace skycap::geometry
