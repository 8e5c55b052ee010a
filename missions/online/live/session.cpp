#include "missions/online/live/session.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "geometry/error.h"
#include "missions/online/live/answer.h"
#include "missions/online/live/scan_input.h"
#include "missions/version.h"

namespace skycap::missions::online {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void reject_message(const std::string& what) {
  throw Error(ErrorKind::bad_file, what);
}

template <typename Value>
std::vector<Value> values_at(const std::string& payload, std::size_t begin, std::size_t count) {
  std::vector<Value> values(count);
  std::memcpy(values.data(), payload.data() + begin, count * sizeof(Value));
  return values;
}

/// Reads an integer from 0 to 2^32 - 1.
std::uint32_t count_at(const Json& header, const char* key) {
  const Json& number = header.at(key);
  constexpr auto max = std::numeric_limits<std::uint32_t>::max();
  const bool is_whole = number.is_number_unsigned() ||
                        (number.is_number_integer() && number.get<std::int64_t>() >= 0);
  if (!is_whole || number.get<std::uint64_t>() > max) {
    reject_message(std::string(key) + " must be an integer from 0 to " + std::to_string(max));
  }
  return number.get<std::uint32_t>();
}

/// Returns an array of numbers as a string for the string parsers.
std::string row_at(const Json& header, const char* key) {
  std::string text;
  for (const Json& number : header.at(key)) text += number.dump() + " ";
  return text;
}

Eigen::Isometry3d make_pose(const Json& header) {
  return parse_pose_text(row_at(header, "pose"), "pose");
}

/// Returns the covariance of a scan's header, if present.
std::optional<PoseCovariance> read_covariance(const Json& header) {
  constexpr const char *sigma = "pose_sigma", *covariance = "pose_covariance";
  if (header.contains(sigma) && header.contains(covariance)) {
    reject_message("pose_sigma conflicts with pose_covariance; remove one of them");
  }
  if (header.contains(sigma)) return parse_pose_sigma(row_at(header, sigma), sigma);
  if (!header.contains(covariance)) return std::nullopt;
  return parse_pose_covariance(row_at(header, covariance), covariance);
}

ScanNumber scan_number(const Json& header) {
  ScanNumber number{count_at(header, "number")};
  // Clients of version 0.1 send "en_route".
  for (const char* field : {"en_route", "on_way"}) {
    if (header.contains(field)) number.en_route = count_at(header, field);
  }
  return number;
}

std::string to_string(const ScanNumber& number) {
  const std::string text = "scan " + std::to_string(number.view);
  return number.en_route ? text + " en-route frame " + std::to_string(*number.en_route) : text;
}

void require_payload(const Message& message, std::size_t size, const std::string& requirement) {
  if (message.payload.size() == size) return;
  reject_message("scan: the payload has " + std::to_string(message.payload.size()) + " bytes; " +
                 requirement + std::to_string(size));
}

/// Reads points in the world frame (floats), followed by pixels if present.
geometry::Scan cloud_scan(const Message& message) {
  const auto count = count_at(message.header, "points");
  const bool has_pixels = message.header.value("has_pixels", false);
  constexpr std::size_t point = 3 * sizeof(float), pixel = sizeof(std::uint32_t);
  const std::size_t size = std::size_t{count} * (point + (has_pixels ? pixel : 0));
  require_payload(message, size, std::to_string(count) + " points require ");
  geometry::Scan scan;
  scan.world_from_sensor = make_pose(message.header);
  scan.points.resize(count);
  if (count > 0) std::memcpy(scan.points.data()->data(), message.payload.data(), count * point);
  if (has_pixels) {
    scan.pixels = values_at<std::uint32_t>(message.payload, count * point, count);
  }
  return scan;
}

/// Reads points in the sensor's optical frame (floats), like a cloud file.
ScanFound sensor_cloud_scan(const Message& message, const flight::CaptureOptions& capture,
                            const LiveOptions& live) {
  const auto count = count_at(message.header, "points");
  constexpr std::size_t point = 3 * sizeof(float);
  require_payload(message, std::size_t{count} * point, std::to_string(count) + " points require ");
  std::vector<Eigen::Vector3d> points;
  points.reserve(count);
  for (const auto& position : values_at<std::array<float, 3>>(message.payload, 0, count)) {
    points.emplace_back(position[0], position[1], position[2]);
  }
  return make_scan(points, make_pose(message.header), capture, live);
}

ScanFound depth_scan(const Message& message, const flight::CaptureOptions& capture,
                     const LiveOptions& live) {
  const Json& header = message.header;
  const std::uint32_t width = count_at(header, "width"), height = count_at(header, "height");
  constexpr std::uint32_t largest_side = 1 << 15;
  if (width < 1 || height < 1 || width > largest_side || height > largest_side) {
    reject_message("scan: width and height must be from 1 to 32768");
  }
  if (std::uint64_t{width} * height > geometry::max_depth_pixels) {
    reject_message("scan: the image has more than 25 million pixels");
  }
  geometry::DepthImage image{static_cast<int>(width), static_cast<int>(height), {}};
  const std::size_t count = std::size_t{width} * height;
  require_payload(message, count * sizeof(std::uint16_t), "the image requires ");
  image.values = values_at<std::uint16_t>(message.payload, 0, count);
  std::optional<CameraIntrinsics> intrinsics;
  if (header.contains("lens")) intrinsics = parse_intrinsics(row_at(header, "lens"), "lens");
  const double unit = header.at("unit").get<double>();
  if (!(unit >= 1e-6 && unit <= 1.0)) reject_message("scan: unit must be from 1e-6 to 1 m");
  return make_scan(image, intrinsics, unit, make_pose(header), capture, live);
}

}  // namespace

Session::Session(std::string mission, const flight::FlightOptions& flight, const LiveOptions& live,
                 LiveSurvey& survey, std::function<std::string()> finish,
                 std::function<void()> show, std::function<bool()> is_held)
    : mission_(std::move(mission)),
      flight_(flight),
      live_(live),
      survey_(survey),
      finish_(std::move(finish)),
      show_(std::move(show)),
      is_held_(std::move(is_held)) {}

void Session::settle() {
  if (std::exchange(has_changed_, false)) show_();
}

bool Session::is_held_back(const Message& answer) const {
  return is_held_() && answer.header.contains("view") && !answer.header["view"].is_null();
}

Message Session::answer(const Message& message) {
  try {
    return answer_unguarded(message);
  } catch (const Json::exception& failure) {
    return error_message(std::string("invalid header (docs/reference/live-protocol.md): ") +
                         failure.what());
  } catch (const Error& failure) {
    return error_message(failure.what());
  }
}

Message Session::answer_unguarded(const Message& message) {
  const auto type = message.header.at("type").get<std::string>();
  if (type == "hello") {
    Message answer = present();
    answer.header["version"] = version;
    answer.header["mission"] = mission_;
    return answer;
  }
  if (type == "next") return present();
  if (type == "scan") return add_scan(message);
  if (type == "refuse") return reject(message);
  if (type == "finish") {
    if (survey_.views().empty()) reject_message("finish: no scan has been accepted yet");
    Message answer{{{"type", "finished"}, {"text", finish_()}}, {}};
    is_finished_ = true;
    return answer;
  }
  reject_message("unknown type '" + type + "'; expected hello, scan, next, refuse or finish");
}

bool Session::is_added(const ScanNumber& number) const {
  return number.view < survey_.views().size() ||
         (number.en_route && *number.en_route < survey_.en_route());
}

std::string Session::next_text() const {
  const std::size_t next = survey_.views().size();
  std::string text = "the next one is " + std::to_string(next);
  if (flight_.capture.is_moving && next > 0) {
    text += ", or en-route frame " + std::to_string(survey_.en_route());
  }
  return text;
}

void Session::require_in_order(const ScanNumber& number) const {
  const std::size_t next = survey_.views().size();
  const bool is_ahead = number.view > next || (number.view == next && number.en_route &&
                                               *number.en_route > survey_.en_route());
  if (is_ahead) reject_message(to_string(number) + " is out of order: " + next_text());
}

Message Session::add_scan(const Message& message) {
  const auto format = message.header.at("format").get<std::string>();
  if (format != "points" && format != "cloud" && format != "depth") {
    reject_message("scan: unknown format '" + format + "'; expected points, cloud or depth");
  }
  const ScanNumber number = scan_number(message.header);
  require_in_order(number);
  ScanFound found;
  if (format == "points") {
    found.scan = cloud_scan(message);
    require_usable(found.scan, flight_);
    found.left_out = filter(found.scan, flight_.capture.camera, live_);
  } else {
    found = format == "cloud" ? sensor_cloud_scan(message, flight_.capture, live_)
                              : depth_scan(message, flight_.capture, live_);
    require_usable(found.scan, flight_);
  }
  const geometry::Scan& scan = found.scan;
  const std::optional<PoseCovariance> covariance = read_covariance(message.header);
  if (is_added(number) && survey_.scan_number(scan_id(scan, covariance)) != number) {
    reject_message(to_string(number) + " was a different scan; " + next_text());
  }
  const bool is_new = number.en_route ? survey_.add_en_route(scan, "", covariance)
                                      : survey_.add(scan, "", covariance);
  has_changed_ = is_new;
  Message answer = present();
  answer.header["is_new"] = is_new;
  if (live_.removes_flying_pixels) {
    answer.header["flying_pixels"] = found.left_out.flying;
    answer.header["isolated_returns"] = found.left_out.isolated;
  }
  return answer;
}

Message Session::reject(const Message& message) {
  const auto id = std::size_t{count_at(message.header, "id")};
  const std::size_t present_id = survey_.proposal().number;
  if (id > present_id) {
    reject_message("refuse: unknown proposal " + std::to_string(id) + "; the current one is " +
                   std::to_string(present_id));
  }
  // A proposal that was already refused is acknowledged.
  if (id == present_id) {
    survey_.reject(message.header.value("reason", std::string("not stated")));
    has_changed_ = true;
  }
  return present();
}

Message Session::present() const {
  Message answer{Json::parse(answer_json(survey_, flight_)), {}};
  answer.header["type"] = "answer";
  return answer;
}

}  // namespace skycap::missions::online
