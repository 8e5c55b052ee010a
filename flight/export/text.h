/// Number formatting and parsing for files, independent of the locale.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::flight {

/// Returns fixed-point text with `decimals` digits, without a sign for zero.
std::string fixed(double value, int decimals);

/// Returns degrees with a resolution of 1e-9, which is 0.1 mm on the ground.
inline std::string degrees(double value) { return fixed(value, 9); }

/// Returns the value rounded to 9 decimals, for writers with their own number formatting.
double rounded_degrees(double value);

/// Parses all of `text` as a finite number. Returns std::nullopt on failure.
std::optional<double> to_number(std::string_view text);

std::vector<std::string> split(std::string_view text, char separator);

/// Returns the lines without their terminators "\n" or "\r\n". A final line without terminator
/// counts.
std::vector<std::string> split_lines(std::string_view text);

/// Removes the first line from `rest` and returns it without its terminator. For texts with
/// millions of lines.
std::string_view next_line(std::string_view& rest);

/// Findings of a validator. Each entry states location and problem.
using Problems = std::vector<std::string>;

/// Parses the fields as numbers. If a field is not a number, adds a problem with `location` and
/// returns std::nullopt.
std::optional<std::vector<double>> to_numbers(const std::vector<std::string>& fields,
                                              const std::string& location, Problems& problems);

/// Throws Error{bad_file} with the first problem, if any. `what` is the name of the format.
void throw_first(const Problems& problems, const std::string& what);

}  // namespace skycap::flight
