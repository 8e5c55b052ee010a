/// Words and numbers of a text file, with the line they are on for messages. For readers' sources.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "geometry/error.h"

namespace skycap::geometry {

class TextScanner {
 public:
  /// `name` (a path) opens every message. Both must outlive the scanner.
  TextScanner(std::string_view name, std::string_view text, std::size_t first_line = 1)
      : name_(name), text_(text), line_(first_line) {}

  std::size_t line() const { return line_; }
  std::size_t remaining() const { return text_.size() - at_; }

  /// The next word, on this line or a later one; nothing at the end of the text.
  std::optional<std::string_view> word() {
    while (true) {
      if (const auto found = word_in_line()) return found;
      if (!next_line()) return std::nullopt;
    }
  }

  /// The next word on this line; nothing at its end.
  std::optional<std::string_view> word_in_line() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_]) && text_[at_] != '\n') ++at_;
    if (at_ == begin) return std::nullopt;
    return text_.substr(begin, at_ - begin);
  }

  /// Goes to the start of the next line; false if there is none.
  bool next_line() {
    const std::size_t end = text_.find('\n', at_);
    at_ = end == std::string_view::npos ? text_.size() : end + 1;
    if (end != std::string_view::npos) ++line_;
    return end != std::string_view::npos && at_ < text_.size();
  }

  /// `word` as a number; `what` names it in the message, as in "a coordinate".
  template <typename Number>
  Number number(std::optional<std::string_view> word, std::string_view what) const {
    if (!word) fail("ends where " + std::string(what) + " is expected");
    std::string_view digits = *word;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size()) {
      fail("'" + std::string(word->substr(0, 40)) + "' stands where " + std::string(what) +
           " is expected");
    }
    return value;
  }

  [[noreturn]] void fail(const std::string& what) const { fail_at(line_, what); }
  [[noreturn]] void fail_at(std::size_t line, const std::string& what) const {
    throw Error(ErrorKind::bad_file,
                std::string(name_) + ": line " + std::to_string(line) + ": " + what);
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f'; }

  std::string_view name_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_;
};

}  // namespace skycap::geometry
