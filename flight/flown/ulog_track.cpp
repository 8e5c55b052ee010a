#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "flight/calibration/dataflash_messages.h"
#include "flight/export/geodesy.h"
#include "flight/export/text.h"
#include "flight/flown/flown_readers.h"
#include "flight/flown/ulog_file.h"
#include "geometry/angle.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Returns the heading of the x axis, clockwise from north [deg], of a rotation (w, x, y, z) from
/// forward-right-down axes to north-east-down axes.
double yaw_deg(const std::array<double, 4>& q) {
  const auto [w, x, y, z] = q;
  return std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)) /
         geometry::radians_per_degree;
}

/// Returns the pitch of the x axis above the horizon [deg].
double pitch_deg(const std::array<double, 4>& q) {
  const auto [w, x, y, z] = q;
  return std::asin(std::clamp(2.0 * (w * y - z * x), -1.0, 1.0)) / geometry::radians_per_degree;
}

/// Collects the track of a ULog.
class UlogTrack {
 public:
  void add(const UlogMessage& message) {
    if (message.instance() != 0) return;
    const std::string& topic = message.topic();
    if (topic == "vehicle_global_position") add_global(message);
    if (topic == "vehicle_local_position") add_local(message);
    if (topic == "vehicle_gps_position") add_receiver(message);
    if (topic == "home_position") set_home(message);
    if (topic == "vehicle_attitude") set_attitude(message);
    if (topic == "gimbal_device_attitude_status") set_gimbal(message);
    if (topic == "mount_orientation") set_mount(message);
    if (topic == "camera_capture") add_capture(message);
    if (topic == "camera_trigger") add_trigger(message);
  }

  FlownLog finish(const UlogParser& parser) {
    FlownLogBuilder& builder = global_.has_positions()  ? global_
                               : local_.has_positions() ? local_
                                                        : receiver_;
    // camera_trigger is logged at the command, camera_capture at the exposure.
    for (const LoggedState& capture : captures_.empty() ? triggers_ : captures_) {
      builder.add_capture(capture.time, capture.location, capture.above_takeoff, capture.yaw_deg);
      LoggedState& state = builder.log().captures.back();
      state.camera_yaw_deg = capture.camera_yaw_deg;
      state.camera_pitch_deg = capture.camera_pitch_deg;
    }
    if (failed_ > 0) builder.warn(std::to_string(failed_) + " failed captures ignored");
    if (parser.is_truncated()) builder.warn("the last message is incomplete");
    if (parser.skipped() > 0) {
      builder.warn(std::to_string(parser.skipped()) + " damaged bytes skipped");
    }
    if (parser.dropouts() > 0) {
      builder.warn(std::to_string(parser.dropouts()) + " dropouts of the logger, " +
                   fixed(parser.dropped(), 2) + " s in total");
    }
    return builder.finish(
        has_unusable_ ? "contains no geodetic position: the receiver had no three-dimensional fix"
                      : "contains no position (vehicle_global_position or "
                        "vehicle_local_position); set SDLOG_PROFILE to its default");
  }

 private:
  /// Returns the height above the home position, or `unspecified` while it is unknown.
  double above_home(double height) const { return height - home_; }

  void add_location(const UlogMessage& message, const Vector3d& location,
                    FlownLogBuilder& builder) {
    if (const auto time = clock_.read(message.time())) {
      builder.add_position(*time, location, above_home(location.z()));
    }
  }

  void add_global(const UlogMessage& message) {
    const auto latitude = message.number("lat"), longitude = message.number("lon"),
               height = message.number("alt");
    if (!latitude || !longitude || !height) return;
    if (message.number_or("lat_lon_valid", 1.0) == 0.0) return;
    add_location(message, {*latitude, *longitude, *height}, global_);
  }

  void add_local(const UlogMessage& message) {
    const auto x = message.number("x"), y = message.number("y"), z = message.number("z"),
               latitude = message.number("ref_lat"), longitude = message.number("ref_lon"),
               height = message.number("ref_alt");
    if (!x || !y || !z || !latitude || !longitude || !height) return;
    has_unusable_ = true;
    if (message.number_or("xy_global", 0.0) == 0.0 || message.number_or("z_global", 0.0) == 0.0) {
      return;
    }
    const Vector3d origin(*latitude, *longitude, *height);
    const Vector3d local(*y, *x, -*z);
    const bool is_on_earth = origin.allFinite() && std::abs(origin.x()) <= 90.0 &&
                             std::abs(origin.y()) <= 180.0 && std::abs(origin.z()) < 1e5;
    if (!is_on_earth || !local.allFinite() || local.norm() > 1e6) return;
    if (!frame_ || origin != frame_->first) {
      frame_.emplace(origin, LocalFrame({origin.x(), origin.y(), origin.z()}));
    }
    const GeodeticPoint point = frame_->second.to_geodetic(local);
    add_location(message, {point.latitude_deg, point.longitude_deg, point.height}, local_);
  }

  // Since PX4 1.15 degrees and metres, before 1e-7 degrees and millimetres.
  void add_receiver(const UlogMessage& message) {
    has_unusable_ = true;
    if (message.number_or("fix_type", 0.0) < 3.0) return;
    if (const auto latitude = message.number("latitude_deg")) {
      add_location(message,
                   {*latitude, message.number_or("longitude_deg", unspecified),
                    message.number_or("altitude_msl_m", unspecified)},
                   receiver_);
    } else {
      add_location(message,
                   {1e-7 * message.number_or("lat", unspecified),
                    1e-7 * message.number_or("lon", unspecified),
                    1e-3 * message.number_or("alt", unspecified)},
                   receiver_);
    }
  }

  void set_home(const UlogMessage& message) {
    if (message.number_or("valid_alt", 1.0) != 0.0) home_ = message.number_or("alt", unspecified);
  }

  void set_attitude(const UlogMessage& message) {
    const auto q = message.quaternion("q");
    if (!q) return;
    const auto time = clock_.read(message.time());
    if (!time) return;
    for (FlownLogBuilder* builder : {&global_, &local_, &receiver_}) {
      builder->set_yaw(*time, yaw_deg(*q));
    }
  }

  void set_camera(const UlogMessage& message, double yaw, double pitch) {
    const auto time = clock_.read(message.time());
    if (!time || !std::isfinite(pitch)) return;
    camera_yaw_deg_ = yaw, camera_pitch_deg_ = pitch;
    for (FlownLogBuilder* builder : {&global_, &local_, &receiver_}) {
      builder->set_camera(*time, yaw, pitch);
    }
  }

  // GIMBAL_DEVICE_FLAGS of MAVLink: the yaw is relative to north if it is locked, unless the flags
  // state the frame.
  void set_gimbal(const UlogMessage& message) {
    const auto q = message.quaternion("q");
    if (!q) return;
    constexpr unsigned yaw_lock = 16, in_vehicle_frame = 32, in_earth_frame = 64;
    const auto flags = static_cast<unsigned>(message.number_or("device_flags", 0.0));
    const bool is_in_earth_frame = (flags & in_earth_frame) != 0 ||
                                   ((flags & in_vehicle_frame) == 0 && (flags & yaw_lock) != 0);
    const double yaw = yaw_deg(*q) + (is_in_earth_frame ? 0.0 : global_.yaw_deg());
    set_camera(message, yaw, pitch_deg(*q));
  }

  // Roll, pitch and yaw [rad]; the frame of the yaw depends on the mount.
  void set_mount(const UlogMessage& message) {
    const auto pitch = message.number("attitude_euler_angle", 1);
    if (pitch) set_camera(message, unspecified, *pitch / geometry::radians_per_degree);
  }

  void add_capture(const UlogMessage& message) {
    const auto time = clock_.read(message.time());
    if (!time) return;
    if (message.number_or("result", 1.0) == 0.0) {
      ++failed_;
      return;
    }
    const Vector3d location(message.number_or("lat", unspecified),
                            message.number_or("lon", unspecified),
                            message.number_or("alt", unspecified));
    LoggedState capture{
        *time,           location,         above_home(location.z()), global_.yaw_deg(),
        camera_yaw_deg_, camera_pitch_deg_};
    captures_.push_back(capture);
  }

  void add_trigger(const UlogMessage& message) {
    if (const auto time = clock_.read(message.time())) {
      triggers_.push_back({*time, Vector3d::Constant(unspecified), unspecified, global_.yaw_deg(),
                           camera_yaw_deg_, camera_pitch_deg_});
    }
  }

  FlownLogBuilder global_{"PX4 ULog"}, local_{"PX4 ULog"}, receiver_{"PX4 ULog"};
  std::vector<LoggedState> captures_, triggers_;
  double home_ = unspecified, camera_yaw_deg_ = unspecified, camera_pitch_deg_ = unspecified;
  std::size_t failed_ = 0;
  bool has_unusable_ = false;  ///< The log contains positions, perhaps without a fix or reference.
  LogClock clock_{true};
  std::optional<std::pair<Vector3d, LocalFrame>> frame_;  ///< of vehicle_local_position
};

}  // namespace

FlownLog read_ulog_track(std::istream& stream) {
  UlogTrack track;
  UlogParser parser([&](const UlogMessage& message) { track.add(message); });
  parse_in_pieces(
      stream, [&](std::string_view bytes, bool is_last) { return parser.parse(bytes, is_last); });
  return track.finish(parser);
}

}  // namespace skycap::flight
