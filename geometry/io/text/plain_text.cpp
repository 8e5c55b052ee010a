#include "geometry/io/text/plain_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

namespace skycap::geometry {
namespace {

using std::string_view;

/// Replacement character for unpaired surrogates.
constexpr std::uint32_t unknown_character = 0xFFFD;

void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  const auto put_rest = [&](int shift) { put(0x80U | ((code >> shift) & 0x3FU)); };
  if (code < 0x80U) return put(code);
  if (code < 0x800U) {
    put(0xC0U | (code >> 6));
    return put_rest(0);
  }
  if (code < 0x10000U) {
    put(0xE0U | (code >> 12));
    put_rest(6);
    return put_rest(0);
  }
  put(0xF0U | (code >> 18));
  put_rest(12);
  put_rest(6);
  put_rest(0);
}

bool is_high_half(std::uint32_t unit) { return unit >= 0xD800U && unit < 0xDC00U; }
bool is_low_half(std::uint32_t unit) { return unit >= 0xDC00U && unit < 0xE000U; }

std::string utf16_to_utf8(string_view bytes, bool is_big_endian) {
  const auto unit_at = [&](std::size_t i) -> std::uint32_t {
    const auto first = static_cast<std::uint8_t>(bytes[i]),
               second = static_cast<std::uint8_t>(bytes[i + 1]);
    return is_big_endian ? (std::uint32_t{first} << 8) | second
                         : (std::uint32_t{second} << 8) | first;
  };
  std::string text;
  text.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t code = unit_at(i);
    if (is_high_half(code) && i + 3 < bytes.size() && is_low_half(unit_at(i + 2))) {
      code = 0x10000U + ((code - 0xD800U) << 10) + (unit_at(i + 2) - 0xDC00U);
      i += 2;
    } else if (is_high_half(code) || is_low_half(code)) {
      code = unknown_character;
    }
    append_utf8(text, code);
  }
  return text;
}

/// Parses spellings that std::from_chars does not support.
std::optional<double> special_number(string_view digits) {
  const bool is_negative = digits.starts_with('-');
  if (is_negative) digits.remove_prefix(1);
  const std::string word = lower_case(digits);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (word == "1.#inf" || word == "1.#inf00") return is_negative ? -infinity : infinity;
  if (word.starts_with("1.#") && word.size() > 3) return nan;  // QNAN, SNAN, IND, J
  if (word == "nan" || (word.starts_with("nan(") && word.ends_with(')'))) return nan;
  if (word == "inf" || word == "infinity") return is_negative ? -infinity : infinity;
  return std::nullopt;
}

/// Returns infinity for numbers above the range of double, and zero for numbers below it.
double beyond_range(string_view digits) {
  // The digits before the point and the exponent distinguish both cases.
  const std::size_t exponent = digits.find_first_of("eE");
  const bool is_tiny =
      exponent != string_view::npos && digits.substr(exponent + 1).starts_with('-');
  const double sign = digits.starts_with('-') ? -1.0 : 1.0;
  return sign * (is_tiny || digits.starts_with("0.") || digits.starts_with("-0.")
                     ? 0.0
                     : std::numeric_limits<double>::infinity());
}

}  // namespace

std::string as_utf8(std::string bytes) {
  if (bytes.starts_with(utf8_mark)) {
    bytes.erase(0, utf8_mark.size());
    return bytes;
  }
  const auto is = [&](std::size_t i, int value) {
    return i < bytes.size() && static_cast<std::uint8_t>(bytes[i]) == value;
  };
  if (is(0, 0xFF) && is(1, 0xFE)) return utf16_to_utf8(string_view(bytes).substr(2), false);
  if (is(0, 0xFE) && is(1, 0xFF)) return utf16_to_utf8(string_view(bytes).substr(2), true);
  const auto is_ascii = [&](std::size_t i) { return i < bytes.size() && bytes[i] >= '\t'; };
  if (is_ascii(0) && is(1, 0) && is_ascii(2) && is(3, 0)) return utf16_to_utf8(bytes, false);
  if (is(0, 0) && is_ascii(1) && is(2, 0) && is_ascii(3)) return utf16_to_utf8(bytes, true);
  return bytes;
}

std::string plain_text(std::string bytes) {
  std::string text = as_utf8(std::move(bytes));
  std::size_t from = text.find('\r');
  if (from == std::string::npos) return text;
  std::size_t to = from;
  for (; from < text.size(); ++from) {
    if (text[from] != '\r') {
      text[to++] = text[from];
    } else if (from + 1 == text.size() || text[from + 1] != '\n') {
      text[to++] = '\n';
    }
  }
  text.resize(to);
  return text;
}

std::optional<double> number_in(string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  if (text.empty() || text.starts_with('+')) return std::nullopt;
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && stop == end) return value;
  if (error == std::errc::result_out_of_range && stop == end) return beyond_range(text);
  return special_number(text);
}

std::optional<double> number_with_comma(string_view text) {
  if (text.find(',') == string_view::npos) return number_in(text);
  std::string with_point(text.substr(0, 64));
  if (with_point.size() < text.size() || std::ranges::count(with_point, ',') != 1 ||
      with_point.find('.') != std::string::npos) {
    return std::nullopt;
  }
  std::ranges::replace(with_point, ',', '.');
  return number_in(with_point);
}

bool has_decimal_comma(string_view text) {
  return text.find(',') != string_view::npos && number_with_comma(text).has_value();
}

std::string lower_case(string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

}  // namespace skycap::geometry
