/// Text as other programs write it: marks of its encoding, ends of its lines, its numbers. Every
/// reader of text opens it and reads its numbers here.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "geometry/text_parts.h"

namespace skycap::geometry {

/// The bytes that mark a text as UTF-8.
inline constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";

/// A file's bytes as UTF-8 without a mark, with lines that end with \n: UTF-16 is told by its mark
/// or by a first character from ASCII; lines may end with \r\n, \r or \n.
std::string plain_text(std::string bytes);

/// The same without a change to the ends of lines, for bytes that may be no text at all.
std::string as_utf8(std::string bytes);

/// A real number as programs write it, with a sign or without; also NaN and infinity, in all
/// spellings of C and of Microsoft's library (nan, -nan(ind), 1.#QNAN, inf, -1.#INF). What is
/// larger than the largest number is infinite. Nothing if all of the text is not one number.
std::optional<double> number_in(std::string_view text);

/// The same where a comma may stand for the decimal point.
std::optional<double> number_with_comma(std::string_view text);

/// Whether the text would be a number if its comma were a point.
bool has_decimal_comma(std::string_view text);

/// With small letters of ASCII only.
std::string lower_case(std::string_view text);

}  // namespace skycap::geometry
