#include <cmath>
#include <optional>
#include <vector>

#include "flight/calibration/dataflash_messages.h"
#include "flight/flown/flown_readers.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Collects the track of a dataflash log.
class DataflashTrack {
 public:
  void add(const DataflashMessage& message) {
    const std::string& name = message.name();
    if (name == "POS") add_position(message, positions_, "RelHomeAlt");
    if (name == "GPS") add_receiver(message);
    if (name == "ATT") set_attitude(message);
    if (name == "MNT") set_mount(message);
    if (name == "CAM") add_capture(message, camera_);
    if (name == "TRIG") add_capture(message, triggers_);
  }

  FlownLog finish(const DataflashParser& parser) {
    FlownLogBuilder& builder = positions_.has_positions() ? positions_ : receiver_;
    // A camera with feedback logs TRIG at the command and CAM at the exposure.
    for (const LoggedState& capture : camera_.empty() ? triggers_ : camera_) {
      builder.add_capture(capture.time, capture.location, capture.above_takeoff, capture.yaw_deg);
      LoggedState& state = builder.log().captures.back();
      state.camera_yaw_deg = capture.camera_yaw_deg;
      state.camera_pitch_deg = capture.camera_pitch_deg;
    }
    if (parser.is_truncated()) builder.warn("the last message is incomplete");
    if (parser.skipped() > 0) {
      builder.warn(std::to_string(parser.skipped()) + " damaged bytes skipped");
    }
    return builder.finish(
        has_receiver_ ? "contains no position: the receiver had no three-dimensional fix"
                      : "contains no position (POS or GPS); set LOG_BITMASK to its default");
  }

 private:
  static std::optional<Vector3d> read_location(const DataflashMessage& message) {
    const auto latitude = message.number("Lat"), longitude = message.number("Lng"),
               height = message.number("Alt");
    if (!latitude || !longitude || !height) return std::nullopt;
    return Vector3d(*latitude, *longitude, *height);
  }

  void add_position(const DataflashMessage& message, FlownLogBuilder& builder,
                    const char* height_label) {
    const std::optional<Vector3d> location = read_location(message);
    if (!location) return;
    if (const auto time = clock_.read(message.time())) {
      builder.add_position(*time, *location, message.number_or(height_label, unspecified));
    }
  }

  // Uses the first receiver while it has a three-dimensional position.
  void add_receiver(const DataflashMessage& message) {
    constexpr double is_3d = 3.0;
    if (message.number_or("I", 0.0) != 0.0) return;
    has_receiver_ = true;
    if (message.number_or("Status", is_3d) < is_3d) return;
    add_position(message, receiver_, "RelAlt");
  }

  void set_attitude(const DataflashMessage& message) {
    if (message.number_or("I", 0.0) != 0.0) return;
    const auto yaw = message.number("Yaw");
    const auto time = clock_.read(message.time());
    if (!yaw || !time) return;
    positions_.set_yaw(*time, *yaw);
    receiver_.set_yaw(*time, *yaw);
  }

  // Before Copter 4.3, MNT does not exist, and the direction of the camera is not logged.
  void set_mount(const DataflashMessage& message) {
    if (message.number_or("I", 0.0) != 0.0) return;
    const auto pitch = message.number("Pitch");
    const auto time = clock_.read(message.time());
    if (!pitch || !time) return;
    double yaw = message.number_or("YawE", unspecified);
    if (!std::isfinite(yaw)) yaw = positions_.yaw_deg() + message.number_or("YawB", unspecified);
    positions_.set_camera(*time, yaw, *pitch);
    receiver_.set_camera(*time, yaw, *pitch);
    camera_yaw_deg_ = yaw, camera_pitch_deg_ = *pitch;
  }

  void add_capture(const DataflashMessage& message, std::vector<LoggedState>& captures) {
    const auto time = clock_.read(message.time());
    if (!time) return;
    Vector3d location = read_location(message).value_or(Vector3d::Constant(unspecified));
    captures.push_back({*time, location, message.number_or("RelAlt", unspecified),
                        message.number_or("Yaw", message.number_or("Y", unspecified)),
                        camera_yaw_deg_, camera_pitch_deg_});
  }

  FlownLogBuilder positions_{"ArduPilot dataflash log"}, receiver_{"ArduPilot dataflash log"};
  std::vector<LoggedState> camera_, triggers_;
  double camera_yaw_deg_ = unspecified, camera_pitch_deg_ = unspecified;
  bool has_receiver_ = false;  ///< The log contains messages of the first receiver.
  LogClock clock_{true};
};

}  // namespace

FlownLog read_dataflash_track(std::istream& stream) {
  DataflashTrack track;
  DataflashParser parser([&](const DataflashMessage& message) { track.add(message); });
  parse_in_pieces(
      stream, [&](std::string_view bytes, bool is_last) { return parser.parse(bytes, is_last); });
  if (!parser.has_format()) {
    throw Error(ErrorKind::bad_file, "is not an ArduPilot dataflash log: it defines no messages");
  }
  return track.finish(parser);
}

}  // namespace skycap::flight
