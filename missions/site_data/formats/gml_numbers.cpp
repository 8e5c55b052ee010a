#include "missions/site_data/formats/gml_numbers.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

void append_gml_numbers(const std::filesystem::path& file, std::string_view text,
                        const GmlSeparators& separators, std::vector<double>& numbers) {
  const char point = separators.decimal.empty() ? '.' : separators.decimal[0];
  std::string gaps = " \n\t\r," + separators.coordinate_separator + separators.of_tuples;
  std::erase(gaps, point);
  std::string with_points;
  if (point != '.') {
    with_points = text;
    std::ranges::replace(with_points, point, '.');
    text = with_points;
  }
  const auto is_gap = [&](char c) { return gaps.find(c) != std::string::npos; };
  for (std::size_t i = 0; i < text.size();) {
    if (is_gap(text[i])) {
      ++i;
      continue;
    }
    if (text[i] == '+') ++i;
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data() + i, text.data() + text.size(), number);
    const auto next = static_cast<std::size_t>(end - text.data());
    if (error != std::errc() || !std::isfinite(number) ||
        (next < text.size() && !is_gap(text[next]))) {
      fail_file(file, "has the coordinate '" + std::string(text.substr(i, 20)) +
                          "'; it must be a number");
    }
    numbers.push_back(number);
    i = next;
  }
}

}  // namespace skycap::missions::site_data
