#include "flight/calibration/flight_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "flight/export/text.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

[[noreturn]] void fail(std::size_t line, const std::string& what) {
  throw Error(ErrorKind::bad_file, "line " + std::to_string(line) + " " + what);
}

constexpr std::array column_names{"time_s", "east_m_s", "north_m_s", "up_m_s", "power_w"};

using Columns = std::array<std::size_t, column_names.size()>;

Columns find_columns(const std::vector<std::string>& header) {
  Columns columns{};
  for (std::size_t i = 0; i < column_names.size(); ++i) {
    const auto found = std::ranges::find(header, column_names[i]);
    if (found == header.end()) fail(1, std::string("has no column ") + column_names[i]);
    columns[i] = static_cast<std::size_t>(found - header.begin());
  }
  return columns;
}

LogSample parse_sample(const std::vector<std::string>& fields, const Columns& columns,
                       std::size_t line) {
  std::array<double, column_names.size()> values{};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] >= fields.size()) fail(line, "has too few fields");
    const std::optional<double> value = to_number(fields[columns[i]]);
    if (!value || !std::isfinite(*value)) {
      fail(line,
           "has \"" + fields[columns[i]] + "\" for " + column_names[i] + "; it must be a number");
    }
    values[i] = *value;
  }
  return {values[0], {values[1], values[2], values[3]}, values[4]};
}

}  // namespace

FlightLog read_csv_log(std::string_view text, std::size_t max_samples) {
  FlightLog log;
  Columns columns{};
  std::size_t number = 0;
  bool has_header = false;
  for (std::string_view rest = geometry::without_mark(text); !rest.empty();) {
    const std::string_view line = next_line(rest);
    ++number;
    if (geometry::trimmed(line).empty()) continue;
    std::vector<std::string> fields = split(line, ',');
    for (std::string& field : fields) field = geometry::trimmed(field);
    if (!has_header) {
      has_header = true;
      columns = find_columns(fields);
      continue;
    }
    if (log.samples.size() == max_samples) {
      fail(number, "exceeds the limit of " + std::to_string(max_samples) + " samples");
    }
    log.samples.push_back(parse_sample(fields, columns, number));
    const std::size_t count = log.samples.size();
    if (count > 1 && log.samples[count - 1].time <= log.samples[count - 2].time) {
      fail(number, "has a time that is not later than that of the previous line");
    }
  }
  if (log.samples.empty()) fail(number, "must be followed by at least one sample");
  return log;
}

FlightLog read_flight_log(const std::filesystem::path& file) {
  const std::string content = geometry::read_file(file, largest_log);
  try {
    return file.extension() == ".csv" ? read_csv_log(content) : read_dataflash(content);
  } catch (const Error& error) {
    throw Error(error.kind(), file.string() + ": " + error.what());
  }
}

}  // namespace skycap::flight
