/// Numbers as files want them, whatever the user's locale.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::flight {

/// Fixed point with `decimals` digits; no sign on zero.
std::string fixed(double value, int decimals);

/// 1e-9 degrees: a tenth of a millimetre.
inline std::string degrees(double value) { return fixed(value, 9); }

/// The value rounded to 9 decimals, for writers that print numbers themselves.
double rounded_degrees(double value);

/// All of `text` as a number; nothing if it is not one, or not finite.
std::optional<double> to_number(std::string_view text);

std::vector<std::string> split(std::string_view text, char separator);

/// Lines without their ends, which may be "\n" or "\r\n". A last line without an end counts.
std::vector<std::string> lines_of(std::string_view text);

/// The first line of `rest`, in the same way, which loses it; for texts of millions of lines.
std::string_view next_line(std::string_view& rest);

/// What a validator found. Each entry names the place and what is wrong with it.
using Problems = std::vector<std::string>;

/// The fields at `place` as numbers. Nothing if one of them is none, which is then a problem.
std::optional<std::vector<double>> to_numbers(const std::vector<std::string>& fields,
                                              const std::string& place, Problems& problems);

/// Throws Error{bad_file} with the first problem, if there is one; `what` names the format.
void throw_first(const Problems& problems, const std::string& what);

}  // namespace skycap::flight
