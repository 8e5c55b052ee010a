#include "flight/flown/flown_log.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "flight/calibration/foreign_log.h"
#include "flight/export/text.h"
#include "flight/flown/flown_readers.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

/// Maximum age of a heading or a direction of the camera [s].
constexpr double max_age = 2.0;

std::string seconds_text(double seconds) { return fixed(seconds, 1) + " s"; }

bool is_on_earth(const Eigen::Vector3d& location, bool is_local) {
  if (!location.allFinite()) return false;
  if (is_local) return true;
  // Receivers without a fix report 0, 0.
  return std::abs(location.x()) <= 90.0 && std::abs(location.y()) <= 180.0 &&
         (location.x() != 0.0 || location.y() != 0.0) && std::abs(location.z()) < 1e5;
}

/// Returns the state at `time`, linear between the two neighbours.
LoggedState interpolate(const std::vector<LoggedState>& states, double time) {
  const auto after = std::ranges::lower_bound(states, time, {}, &LoggedState::time);
  if (after == states.begin()) return states.front();
  if (after == states.end()) return states.back();
  const LoggedState& a = *std::prev(after);
  const double t = after->time > a.time ? (time - a.time) / (after->time - a.time) : 0.0;
  LoggedState state = a;
  state.location += t * (after->location - a.location);
  state.above_takeoff += t * (after->above_takeoff - a.above_takeoff);
  return state;
}

/// Throws Error{bad_file} for flight records of DJI, which only DJI can decrypt.
void reject_encrypted(const std::filesystem::path& file) {
  std::string name = file.filename().string();
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool is_record = name.starts_with("djiflightrecord") && name.ends_with(".txt");
  const bool is_dat = name.ends_with(".dat");
  if (!is_record && !is_dat) return;
  throw Error(ErrorKind::bad_file,
              std::string("is an encrypted DJI flight ") + (is_dat ? "log (.DAT)" : "record") +
                  "; export it as CSV with AirData or another log service, or use the .MRK file "
                  "that is stored with the photos");
}

FlownLog read_text(const std::filesystem::path& file, const std::string& extension) {
  const std::string content = geometry::read_file(file);
  const std::string_view text = geometry::without_mark(content);
  if (extension == ".mrk") return read_mrk_track(text);
  if (extension == ".gpx") return read_gpx_track(content);
  if (extension == ".srt") return read_srt_track(text);
  if (extension == ".csv") {
    return text.starts_with("# frame") ? read_trajectory_track(content) : read_csv_track(text);
  }
  if (extension == ".tum" || extension == ".txt") return read_tum_track(content);
  const std::string kind = foreign_kind(content);
  throw Error(ErrorKind::bad_file,
              kind.empty() || kind.starts_with("a plain-text file")
                  ? "is not a flight log: expected .bin, .ulg, .csv, .mrk, .gpx, .srt or .tum"
                  : "is not a flight log with positions: it is " + kind);
}

FlownLog read(const std::filesystem::path& file) {
  reject_encrypted(file);
  geometry::require_regular_file(file);
  std::ifstream stream = geometry::open_stream(file);
  if (!stream.is_open()) throw Error(ErrorKind::bad_file, "cannot be opened");
  std::array<char, 4> start{};
  stream.read(start.data(), start.size());
  const std::string_view mark(start.data(), static_cast<std::size_t>(stream.gcount()));
  stream.clear();
  stream.seekg(0);
  if (mark == "ULog") return read_ulog_track(stream);
  const std::string extension = geometry::lower_extension(file);
  if (mark.starts_with("\xA3\x95") || extension == ".bin") return read_dataflash_track(stream);
  return read_text(file, extension);
}

}  // namespace

void FlownLogBuilder::set_yaw(double time, double yaw_deg) {
  if (!std::isfinite(yaw_deg)) return;
  yaw_deg_ = yaw_deg;
  yaw_time_ = time;
}

void FlownLogBuilder::set_camera(double time, double yaw_deg, double pitch_deg) {
  if (!std::isfinite(pitch_deg)) return;
  camera_yaw_deg_ = yaw_deg;
  camera_pitch_deg_ = pitch_deg;
  camera_time_ = time;
}

LoggedState FlownLogBuilder::make_state(double time, const Eigen::Vector3d& location,
                                        double above_takeoff) const {
  LoggedState state{time, location, above_takeoff};
  if (std::abs(time - yaw_time_) <= max_age) state.yaw_deg = yaw_deg_;
  if (std::abs(time - camera_time_) <= max_age) {
    state.camera_yaw_deg = camera_yaw_deg_;
    state.camera_pitch_deg = camera_pitch_deg_;
  }
  return state;
}

void FlownLogBuilder::add_position(double time, const Eigen::Vector3d& location,
                                   double above_takeoff) {
  if (!std::isfinite(time) || !is_on_earth(location, log_.is_local)) return;
  if (time < last_position_) return;  // false for the first position
  const double gap = time - last_position_;
  if (gap > min_log_gap) {
    ++gaps_;
    lost_ += gap;
    if (gap > longest_gap_) longest_gap_ = gap, gap_time_ = last_position_;
  }
  last_position_ = time;
  // The tolerance keeps every position of a log at exactly this interval.
  if (!log_.states.empty() && time - log_.states.back().time < min_state_interval - 1e-3) return;
  log_.states.push_back(make_state(time, location, above_takeoff));
}

void FlownLogBuilder::add_capture(double time, const Eigen::Vector3d& location,
                                  double above_takeoff, double yaw_deg) {
  log_.has_captures = true;
  LoggedState state = make_state(time, location, above_takeoff);
  if (std::isfinite(yaw_deg)) state.yaw_deg = yaw_deg;
  if (!is_on_earth(location, log_.is_local)) state.location.setConstant(unspecified);
  log_.captures.push_back(state);
}

FlownLog FlownLogBuilder::finish(const std::string& missing) {
  if (log_.states.empty()) throw Error(ErrorKind::bad_file, missing);
  std::ranges::stable_sort(log_.captures, {}, &LoggedState::time);
  for (LoggedState& capture : log_.captures) {
    if (capture.location.allFinite()) continue;
    const LoggedState state = interpolate(log_.states, capture.time);
    capture.location = state.location;
    capture.above_takeoff = state.above_takeoff;
  }
  if (gaps_ > 0) {
    warn(std::to_string(gaps_) + (gaps_ == 1 ? " gap" : " gaps") + " without positions, " +
         seconds_text(lost_) + " in total, longest " + seconds_text(longest_gap_) + " after " +
         seconds_text(gap_time_ - log_.states.front().time));
  }
  return std::move(log_);
}

void parse_in_pieces(std::istream& stream,
                     const std::function<std::size_t(std::string_view, bool)>& parse) {
  constexpr std::size_t piece = std::size_t{1} << 20;
  std::string buffer;
  for (bool is_last = false; !is_last;) {
    const std::size_t kept = buffer.size();
    buffer.resize(kept + piece);
    stream.read(buffer.data() + kept, piece);
    const auto count = static_cast<std::size_t>(stream.gcount());
    buffer.resize(kept + count);
    is_last = count < piece;
    buffer.erase(0, parse(buffer, is_last));
  }
}

FlownLog read_flown_log(const std::filesystem::path& file) {
  try {
    return read(file);
  } catch (const Error& error) {
    throw Error(error.kind(), file.string() + ": " + error.what());
  }
}

}  // namespace skycap::flight
