// Data from links: MAVLink messages of an autopilot and messages of a live survey's client.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "flight/mavlink/frame.h"
#include "flight/mavlink/guided_messages.h"
#include "flight/mavlink/vehicle_state.h"
#include "geometry/pose/world.h"
#include "missions/config/resolve.h"
#include "missions/online/live/kept_scan.h"
#include "missions/online/live/live_journal.h"
#include "missions/online/live/live_survey.h"
#include "missions/online/live/pose_covariance.h"
#include "missions/online/live/scan_input.h"
#include "missions/online/live/session.h"
#include "missions/online/live/wire.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/trial_run.h"

namespace skycap::fuzz {
namespace {

namespace online = missions::online;
namespace mavlink = flight::mavlink;

void require_sane(const mavlink::VehicleState& state) {
  if (const auto& position = state.position()) {
    require(std::abs(position->latitude_deg) <= 90.0 && std::abs(position->longitude_deg) <= 180.0,
            "a vehicle off the Earth");
    require(std::isfinite(position->height_above_home) && position->velocity.allFinite(),
            "a vehicle at no height");
  }
  for (const auto& number : {state.yaw(), state.gimbal_pitch(), state.battery()}) {
    require(!number || std::isfinite(*number), "a vehicle of no number");
  }
  for (const char c : state.warning()) {
    require(std::isprint(static_cast<unsigned char>(c)) != 0, "a warning that is not printable");
  }
}

void hear_all(mavlink::FrameReader& reader, mavlink::VehicleState& state, double& now) {
  while (const auto frame = reader.next()) {
    require(frame->payload.size() <= 255, "a payload longer than a frame");
    state.hear(*frame, now += 0.1);
    require_sane(state);
  }
}

/// Reads the bytes in pieces as link data, and as frames with valid checksums: six header bytes,
/// the payload length, the payload. Without valid checksums, the message parsers would hardly be
/// reached.
int run_mavlink(const std::uint8_t* bytes, std::size_t size) {
  double now = 0.0;
  mavlink::VehicleState state, sealed_state;
  mavlink::FrameReader reader(mavlink::guided_extra_byte), sealed(mavlink::guided_extra_byte);
  for (std::size_t at = 0; at < size; at += 97) {
    reader.feed({bytes + at, std::min<std::size_t>(97, size - at)});
    hear_all(reader, state, now);
  }
  constexpr std::size_t head = 7;
  for (std::size_t at = 0; at + head <= size;) {
    const std::size_t length = std::min<std::size_t>(bytes[at + 6], size - at - head);
    mavlink::Frame frame;
    frame.id =
        bytes[at] | (std::uint32_t{bytes[at + 1]} << 8) | (std::uint32_t{bytes[at + 2]} << 16);
    frame.sender = {bytes[at + 3], bytes[at + 4]};
    frame.sequence = bytes[at + 5];
    frame.payload.assign(bytes + at + head, bytes + at + head + length);
    at += head + length;
    sealed.feed(mavlink::wire_form(frame, mavlink::guided_extra_byte(frame.id).value_or(0)));
    hear_all(sealed, sealed_state, now);
  }
  return 0;
}

/// Reads the bytes as they arrive at the socket.
int run_wire(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("", [&] {
    online::FrameReader reader;
    const std::string text = bytes_to_string(bytes, size);
    for (std::size_t at = 0; at < size; at += 61) {
      reader.feed(std::string_view(text).substr(at, 61));
      while (const auto message = reader.next()) {
        require(message->header.is_object(), "a header that is no object");
        online::FrameReader again;
        again.feed(online::encode_frame(*message));
        require(again.next()->payload == message->payload, "a message changes on its way");
      }
    }
  });
}

/// Returns the setup of a live survey with a depth camera or a scanner.
const missions::config::MissionSetup& live_setup(bool has_scanner) {
  constexpr const char* rest =
      "planner: {name: see++, density: 5200, resolution_radius: 0.0525, occluder_spacing: 0.03,\n"
      "          view_distance: 1, scene_box: {min: [-1, -1, -1], max: [1, 1, 1]}}\n"
      "evaluation: {coverage_distance: 0.03}\n"
      "live: {remove_flying_pixels: true, registration: true, pose_sigma: 0.01}\n"
      "limits: {max_views: 4}\n";
  static const missions::config::MissionSetup camera = missions::config::parse_mission(
      std::string("sensor: {width: 16, height: 12}\n") + rest, "m.yaml");
  static const missions::config::MissionSetup scanner = missions::config::parse_mission(
      std::string("sensor: {lidar: velodyne_vlp16}\n") + rest, "m.yaml");
  return has_scanner ? scanner : camera;
}

/// Reads consecutive messages without checksums: a line of JSON, two bytes for the payload length,
/// the payload. The first byte selects the sensor.
int run_session(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const missions::config::MissionSetup& setup = live_setup(bytes[0] == 's');
  online::LiveSurvey survey(setup.survey(), setup.live, setup.identity(), fresh_folder(), {}, 1);
  online::Session session(setup.name, setup.flight(), setup.live, survey,
                          [] { return std::string("done"); });
  const std::string text = bytes_to_string(bytes + 1, size - 1);
  for (std::size_t at = 0, messages = 0; at < text.size() && messages < 6; ++messages) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string header = text.substr(at, end - at);
    at = std::min(end + 3, text.size());
    online::Message message{online::Message().header.parse(header, nullptr, false), {}};
    if (!message.header.is_object()) return 0;
    if (end + 2 < text.size()) {
      const auto low = static_cast<std::uint8_t>(text[end + 1]);
      const auto high = static_cast<std::uint8_t>(text[end + 2]);
      message.payload = text.substr(at, low + (std::size_t{high} << 8));
      at += message.payload.size();
    }
    const online::Message answer = session.answer(message);
    require(answer.header.contains("type"), "an answer of no type");
    online::encode_frame(answer);
    session.settle();
  }
  return 0;
}

/// Reads poses, camera intrinsics and pose uncertainties, as users and messages write them.
int run_pose(const std::uint8_t* bytes, std::size_t size) {
  const std::string text = bytes_to_string(bytes, size);
  run_reader("pose.txt", [&] {
    const Eigen::Isometry3d pose = online::parse_pose_text(text, "pose.txt");
    require(geometry::is_valid_position(pose.translation()), "a pose out of the world");
    const Eigen::Matrix3d turn = pose.linear();
    require((turn * turn.transpose()).isIdentity(1e-6), "a pose that stretches");
  });
  run_reader("lens", [&] {
    const online::CameraIntrinsics intrinsics = online::parse_intrinsics(text, "lens");
    const auto ray = intrinsics.ray({3.0, 5.0});
    require(!ray || ray->allFinite(), "a ray of no number");
  });
  run_reader("sigma", [&] { online::parse_pose_sigma(text, "sigma"); });
  return run_reader("covariance", [&] {
    const auto covariance = online::parse_pose_covariance(text, "covariance");
    require(covariance.position() >= 0.0 && covariance.position() <= 101.0, "an error of no size");
    require(covariance.angle() >= 0.0 && covariance.angle() <= 2.0, "an error of no angle");
  });
}

/// Reads one record in each line.
int run_live_journal(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("live.journal", [&] {
    std::vector<std::string> records(1);
    for (const char c : bytes_to_string(bytes, size)) {
      if (c == '\n') {
        records.emplace_back();
      } else {
        records.back() += c;
      }
    }
    for (const online::LiveEvent& event : online::parse_events(records, "live.journal")) {
      if (!event.scan) continue;
      require(geometry::is_valid_position(event.scan->world_from_sensor.translation()),
              "a scan out of the world");
      const auto file = std::filesystem::path(event.scan->file).lexically_normal();
      require(file.is_relative() && *file.begin() != "..", "a scan out of the folder");
    }
  });
}

/// Reads a scan as stored by a live survey.
int run_kept_scan(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("scan.ply", [&] {
    const geometry::Scan scan = online::parse_kept_scan("scan.ply", bytes_to_string(bytes, size));
    require(scan.pixels.empty() || scan.pixels.size() == scan.points.size(), "pixels of no point");
  });
}

constexpr Reader readers[] = {{"mavlink", run_mavlink},           {"wire", run_wire},
                              {"session", run_session},           {"pose", run_pose},
                              {"live_journal", run_live_journal}, {"kept_scan", run_kept_scan}};

}  // namespace

std::span<const Reader> link_readers() { return readers; }

}  // namespace skycap::fuzz
