#include "missions/inspection/flight_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/file.h"

namespace skycap::missions::inspection {
namespace {

using survey::inspection::FlightSample;
constexpr std::size_t columns = 6;

/// Returns the fields of a line.
std::vector<std::string_view> fields_of(std::string_view line) {
  constexpr std::string_view separators = ",; \t\r";
  std::vector<std::string_view> fields;
  for (std::size_t at = line.find_first_not_of(separators); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    fields.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(separators, end);
  }
  return fields;
}

bool parse(std::string_view field, double& number) {
  const char* const end = field.data() + field.size();
  const auto [parsed, error] = std::from_chars(field.data(), end, number);
  return error == std::errc() && parsed == end && std::isfinite(number);
}

[[noreturn]] void reject(const std::filesystem::path& file, std::size_t line,
                         const std::string& what) {
  throw Error(ErrorKind::bad_file, fmt::format("{}:{}: {}", file.string(), line, what));
}

}  // namespace

std::string write_flight_csv(std::span<const FlightSample> flight) {
  std::string text =
      "# Flight of the camera. t: seconds from the start. x, y, z: metres in the mission frame, "
      "east, north, up.\n"
      "# yaw: radians, counter-clockwise from east, continuous. pitch: radians, 0 at the horizon, "
      "positive upwards.\n"
      "t,x,y,z,yaw,pitch\n";
  for (const FlightSample& sample : flight) {
    text +=
        fmt::format("{:.3f},{:.6f},{:.6f},{:.6f},{:.7f},{:.7f}\n", sample.time, sample.position.x(),
                    sample.position.y(), sample.position.z(), sample.yaw, sample.pitch);
  }
  return text;
}

std::vector<FlightSample> read_flight_csv(const std::filesystem::path& file) {
  const std::string text = geometry::read_file(file);
  std::vector<FlightSample> flight;
  std::size_t number = 0;
  bool may_be_header = true;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line(text.data() + at, end - at);
    at = end + 1;
    ++number;
    const std::vector<std::string_view> fields = fields_of(line);
    if (fields.empty() || fields[0].starts_with('#')) continue;
    std::array<double, columns> values{};
    bool is_valid = fields.size() >= columns;
    for (std::size_t i = 0; i < columns && is_valid; ++i) is_valid = parse(fields[i], values[i]);
    if (!is_valid) {
      if (!may_be_header) reject(file, number, "expected six numbers: t, x, y, z, yaw, pitch");
      may_be_header = false;
      continue;
    }
    may_be_header = false;
    if (!flight.empty() && values[0] <= flight.back().time) {
      reject(file, number, "times must ascend");
    }
    flight.push_back({values[0], {values[1], values[2], values[3]}, values[4], values[5]});
  }
  if (flight.empty()) reject(file, 1, "contains no samples of a flight: t, x, y, z, yaw, pitch");
  return flight;
}

}  // namespace skycap::missions::inspection
