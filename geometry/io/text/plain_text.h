/// Normalisation of text from external sources: encoding, line ends and numbers. All text readers
/// use these functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "geometry/text_parts.h"

namespace skycap::geometry {

/// UTF-8 byte-order mark.
inline constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";

/// Converts the bytes of text files to UTF-8 without byte-order mark and with \n as line end.
/// UTF-16 is detected by its mark or by an ASCII first character. Input lines may end with \r\n, \r
/// or \n.
std::string plain_text(std::string bytes);

/// Converts bytes to UTF-8 without byte-order mark and keeps the line ends. Also for files that may
/// be binary.
std::string as_utf8(std::string bytes);

/// Parses a real number with optional sign, or NaN and infinity in all spellings of C and of
/// Microsoft's library (nan, -nan(ind), 1.#QNAN, inf, -1.#INF). Numbers that exceed the range of
/// double are infinite. Returns nullopt if the text is not exactly one number.
std::optional<double> number_in(std::string_view text);

/// Parses a number like number_in(), but also accepts a decimal comma.
std::optional<double> number_with_comma(std::string_view text);

/// Returns whether the text would be a valid number with a point instead of its comma.
bool has_decimal_comma(std::string_view text);

/// Converts ASCII letters to lower case.
std::string lower_case(std::string_view text);

}  // namespace skycap::geometry
