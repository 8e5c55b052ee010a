#include "flight/calibration/foreign_log.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "geometry/text_parts.h"

namespace skycap::flight {

std::string foreign_kind(std::string_view bytes) {
  struct Kind {
    std::string_view beginning;
    const char* what;
  };
  constexpr const char* use_bin = "; use the vehicle's own .bin log";
  static const std::array kinds{
      Kind{"ULog\x01\x12\x35",
           "a PX4 ULog; use a CSV table with time_s, east_m_s, north_m_s, up_m_s and power_w"},
      Kind{"FMT,", "an ArduPilot text log; use the .bin file that it was converted from"},
      Kind{"\x1f\x8b", "gzip-compressed; unpack it first"},
      Kind{"PK\x03\x04", "a zip archive; unpack it first"},
      Kind{"#ROSBAG", "a ROS bag; use the vehicle's own .bin log"},
      Kind{"MATLAB", "a MATLAB file; use the .bin file that it was converted from"},
      Kind{"H Product:Blackbox",
           "a Betaflight or INAV Blackbox log; use a CSV table with time_s, east_m_s, north_m_s, "
           "up_m_s and power_w"}};
  for (const Kind& kind : kinds) {
    if (geometry::without_mark(bytes).starts_with(kind.beginning)) return kind.what;
  }
  // Telemetry log of a ground station: a timestamp of 8 bytes before each MAVLink frame.
  constexpr std::size_t frame = 8;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  const auto is_frame = [&](std::size_t i) { return byte(i) == 0xFE || byte(i) == 0xFD; };
  if (bytes.size() > frame && is_frame(frame) && byte(0) == 0) {
    return std::string("a ground station's telemetry log (.tlog)") + use_bin;
  }
  if (bytes.size() > 1 && is_frame(0)) return std::string("a raw MAVLink stream") + use_bin;
  const std::string_view start = bytes.substr(0, 1000);
  const bool is_text = !start.empty() && std::ranges::all_of(start, [](char c) {
    return c == '\t' || c == '\n' || c == '\r' || (c >= ' ' && c <= '~');
  });
  if (is_text) return "a plain-text file; the name of a CSV table must end in .csv";
  return bytes.empty() ? "empty" : "";
}

}  // namespace skycap::flight
