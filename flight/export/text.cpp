#include "flight/export/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "geometry/error.h"
#include "geometry/text_parts.h"

namespace skycap::flight {

std::string fixed(double value, int decimals) {
  std::array<char, 400> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::fixed, decimals)
                       .ptr;
  std::string text(buffer.data(), end);
  if (text.front() == '-' && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
  return text;
}

double rounded_degrees(double value) { return std::round(value * 1e9) / 1e9; }

std::optional<double> to_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::vector<std::string> split_lines(std::string_view text) {
  std::vector<std::string> lines;
  for (text = geometry::without_mark(text); !text.empty();) lines.emplace_back(next_line(text));
  return lines;
}

std::string_view next_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
  const std::string_view line = rest.substr(0, end);
  const std::size_t mark = rest.substr(end).starts_with("\r\n") ? 2 : 1;
  rest.remove_prefix(std::min(end + mark, rest.size()));
  return line;
}

std::optional<std::vector<double>> to_numbers(const std::vector<std::string>& fields,
                                              const std::string& location, Problems& problems) {
  std::vector<double> values;
  for (const std::string& field : fields) {
    const std::optional<double> value = to_number(field);
    if (!value) {
      problems.push_back(location + "has \"" + geometry::excerpt(field) +
                         "\", which is not a number");
      return std::nullopt;
    }
    values.push_back(*value);
  }
  return values;
}

void throw_first(const Problems& problems, const std::string& what) {
  if (!problems.empty()) {
    throw Error(ErrorKind::bad_file, what + ": " + problems.front());
  }
}

}  // namespace skycap::flight
