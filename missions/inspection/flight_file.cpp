#include "missions/inspection/flight_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/pose/world.h"
#include "geometry/text_parts.h"

namespace skycap::missions::inspection {
namespace {

using geometry::degrees_per_radian;
using geometry::radians_per_degree;
using survey::inspection::FlightSample;
using survey::inspection::Vertex;
constexpr const char* corner_header = "x,y,z,heading_deg,gimbal_pitch_deg,delay_s";
constexpr std::size_t largest_corner_file = std::size_t{64} << 20;  // [byte]
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

/// Returns the first six numbers of a line, or std::nullopt if one is missing or invalid.
std::optional<std::array<double, columns>> parse_numbers(
    const std::vector<std::string_view>& fields) {
  std::array<double, columns> values{};
  if (fields.size() < columns) return std::nullopt;
  for (std::size_t i = 0; i < columns; ++i) {
    if (!parse(fields[i], values[i])) return std::nullopt;
  }
  return values;
}

/// Calls `callback` with the number and the fields of each line that has fields.
template <class Callback>
void for_each_row(std::string_view text, const Callback& callback) {
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::vector<std::string_view> fields = fields_of(text.substr(at, end - at));
    at = end + 1;
    ++number;
    if (!fields.empty()) callback(number, fields);
  }
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
  bool may_be_header = true;
  for_each_row(text, [&](std::size_t number, const std::vector<std::string_view>& fields) {
    if (fields[0].starts_with('#')) return;
    const auto values = parse_numbers(fields);
    if (!values && !may_be_header) {
      reject(file, number, "expected six numbers: t, x, y, z, yaw, pitch");
    }
    may_be_header = false;
    if (!values) return;
    const auto& [time, x, y, z, yaw, pitch] = *values;
    if (!flight.empty() && time <= flight.back().time) reject(file, number, "times must ascend");
    flight.push_back({time, {x, y, z}, yaw, pitch});
  });
  if (flight.empty()) reject(file, 1, "contains no samples of a flight: t, x, y, z, yaw, pitch");
  return flight;
}

std::string write_corners_csv(std::span<const Vertex> corners) {
  std::string text = corner_header;
  for (const Vertex& corner : corners) {
    const double heading = std::remainder(90.0 - degrees_per_radian * corner.yaw, 360.0);
    text += fmt::format("\n{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}", corner.position.x(),
                        corner.position.y(), corner.position.z(),
                        heading < 0.0 ? heading + 360.0 : heading,
                        degrees_per_radian * corner.pitch, corner.delay);
  }
  return text + "\n";
}

bool is_corner_file(const std::filesystem::path& file) {
  std::error_code ignored;
  if (geometry::lower_extension(file) != ".csv" ||
      !std::filesystem::is_regular_file(file, ignored)) {
    return false;
  }
  std::ifstream stream = geometry::open_stream(file);
  std::string head(256, '\0');  // Other tables may be large.
  stream.read(head.data(), std::ssize(head));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  const std::string_view content = geometry::without_mark(head);
  return geometry::trimmed(content.substr(0, content.find('\n'))) == corner_header;
}

std::vector<Vertex> read_corners_csv(const std::filesystem::path& file) {
  const std::string text = geometry::read_file(file, largest_corner_file);
  std::vector<Vertex> corners;
  for_each_row(text, [&](std::size_t number, const std::vector<std::string_view>& fields) {
    if (number == 1) return;  // the header
    constexpr double max_heading = 360.0, max_pitch = 90.0, max_delay = 86400.0;
    const auto values = parse_numbers(fields);
    if (!values || fields.size() != columns || std::abs((*values)[3]) > max_heading ||
        std::abs((*values)[4]) > max_pitch || (*values)[5] < 0.0 || (*values)[5] > max_delay) {
      reject(file, number,
             fmt::format("expected the numbers {} with headings up to {}, pitches up to {} and "
                         "delays from 0 to {}",
                         corner_header, max_heading, max_pitch, max_delay));
    }
    const auto& [x, y, z, heading, pitch, delay] = *values;
    Vertex corner;
    corner.position = {x, y, z};
    geometry::require_valid_position(corner.position,
                                     fmt::format("{}:{}: the corner", file.string(), number));
    corner.yaw = std::remainder(radians_per_degree * (90.0 - heading), 2.0 * std::numbers::pi);
    corner.pitch = radians_per_degree * pitch;
    corner.delay = delay;
    corners.push_back(corner);
  });
  if (corners.empty()) reject(file, 1, "contains no corner");
  return corners;
}

}  // namespace skycap::missions::inspection
