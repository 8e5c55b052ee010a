#include "clients/ros2/bridge.h"

#include <cmath>
#include <utility>

#include "geometry/error.h"

namespace skycap::ros2 {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Json = nlohmann::json;

Vector3d to_vector(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Isometry3d parse_view(const Json& view) {
  const auto q = view.at("quaternion_xyzw").get<std::vector<double>>();
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(q.at(3), q.at(0), q.at(1), q.at(2)).toRotationMatrix();
  pose.translation() = to_vector(view.at("position"));
  return pose;
}

skycap_live::Pose to_rows(const Isometry3d& pose) {
  skycap_live::Pose rows{};
  for (int i = 0; i < 12; ++i) rows[static_cast<std::size_t>(i)] = pose(i / 4, i % 4);
  return rows;
}

skycap_live::PoseError to_pose_error(const std::optional<Covariance>& covariance) {
  if (!covariance) return {};
  skycap_live::PoseCovariance rows{};
  for (int i = 0; i < 36; ++i) rows[static_cast<std::size_t>(i)] = (*covariance)(i / 6, i % 6);
  return rows;
}

/// Returns the text escaped for a JSON string, without quotes.
std::string escaped(const std::string& text) {
  const std::string quoted = Json(text).dump();
  return quoted.substr(1, quoted.size() - 2);
}

/// Stores the first name in `kept` and requires later names to equal it.
void require_same(std::string& kept, const std::string& name, const std::string& what) {
  if (kept.empty()) kept = name;
  if (kept == name) return;
  throw Error(ErrorKind::bad_geometry, what + " is '" + name + "'; it must remain '" + kept + "'");
}

}  // namespace

Bridge::Bridge(BridgeConfig config, SurveyPort survey, BridgeCallbacks callbacks)
    : config_(std::move(config)),
      survey_(std::move(survey)),
      callbacks_(std::move(callbacks)),
      warnings_(callbacks_.warning),
      history_(config_.history),
      transforms_(config_.history),
      world_frame_(config_.world),
      body_frame_(config_.world.empty() ? "" : config_.body),
      doing_(config_.world.empty() ? "waiting for odometry" : "waiting for transforms") {}

void Bridge::begin() { learn(survey_.next()); }

void Bridge::guarded(const std::string& kind, double now, const std::function<void()>& receive) {
  try {
    receive();
  } catch (const Error& failure) {
    warn_throttled(kind, kind + ": " + failure.what(), now);
  } catch (const skycap_live::Rejected& rejection) {
    constexpr double pause = 1.0;
    warn_throttled(kind, kind + " rejected by the survey: " + printable_text(rejection.what()),
                   now);
    not_before_ = now + pause;
  }
}

void Bridge::warn_throttled(const std::string& kind, const std::string& line, double now) {
  if (warnings_.add(kind, line, now)) publish_status();
}

void Bridge::receive(const Odometry& odometry, double now) {
  guarded("odometry", now, [&] { add_odometry(odometry); });
}

void Bridge::add_odometry(const Odometry& odometry) {
  const Stamp stamp = to_stamp(odometry.header);
  const BodyPose pose = body_pose(odometry);
  require_same(world_frame_, printable_text(odometry.header.frame_id), "its frame");
  require_same(body_frame_, printable_text(odometry.child_frame_id), "its child frame");
  if (history_.add(stamp, pose) == PoseHistory::Added::contradicts) {
    throw Error(ErrorKind::bad_geometry, "two different poses have the same timestamp");
  }
  newest_pose_ = stamp;
  locate();
}

/// Handles the first known body pose.
void Bridge::locate() {
  if (is_located_) return;
  is_located_ = true;
  publish_goal();  // Publishes the goal again, now with its frame.
  set_status("waiting for a scan");
}

void Bridge::receive(const TFMessage& message, bool is_static, double now) {
  for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
    const TransformStamped& transform = message.transforms._buffer[i];
    guarded("transform", now, [&] {
      transforms_.add(transform, is_static);
      if (config_.world.empty()) return;
      if (!is_located_ && transforms_.newest(world_frame_, body_frame_)) locate();
    });
  }
}

void Bridge::receive(const PointCloud2& cloud, double now) {
  guarded("cloud", now, [&] {
    add_scan(cloud.header, now, [&] { return make_scan(cloud, config_.mount.axes()); });
  });
}

void Bridge::receive(const CameraInfo& info, double now) {
  guarded("CameraInfo", now, [&] {
    intrinsics_.reset();
    intrinsics_ = to_intrinsics(info, config_.is_rectified);
  });
}

void Bridge::receive(const Image& image, double now) {
  guarded("image", now, [&] {
    add_scan(image.header, now, [&] {
      if (!intrinsics_) throw Error(ErrorKind::bad_geometry, "no CameraInfo received yet");
      return make_scan(image, *intrinsics_);
    });
  });
}

bool Bridge::wants_scan(double now) const {
  if (waiting_ || is_finished_ || now < not_before_) return false;
  if (is_add_requested_) return true;
  const auto state = answer_.at("state").get<std::string>();
  return config_.taking != Taking::command && !is_suspended_ &&
         (state == "view" || state == "first_scan");
}

void Bridge::add_scan(const Header& header, double now, const std::function<SensorScan()>& scan) {
  const Stamp stamp = to_stamp(header);
  require_same(sensor_frame_, printable_text(header.frame_id), "its frame");
  if (!wants_scan(now)) return;
  if (stamp <= last_added_) {
    throw Error(ErrorKind::bad_geometry,
                "its timestamp must be later than that of the last accepted scan; the scan is a "
                "duplicate, it arrived late, or the robot's clock was set back");
  }
  waiting_ = Waiting{stamp, now, scan()};
}

Bridge::PoseState Bridge::with_mount(const PoseMatch& body, Stamp stamp) const {
  PoseState found{body, config_.mount};
  if (!config_.uses_transforms || body.state != PoseMatch::State::known) return found;
  const PoseMatch sensor = transforms_.at(body_frame_, sensor_frame_, stamp);
  if (sensor.state != PoseMatch::State::known) return {sensor, config_.mount};
  found.mount = Mount(to_isometry(sensor.pose), config_.mount.axes());
  return found;
}

Bridge::PoseState Bridge::at(Stamp stamp) const {
  const bool asks_odometry = config_.world.empty();
  return with_mount(
      asks_odometry ? history_.at(stamp) : transforms_.at(world_frame_, body_frame_, stamp), stamp);
}

std::optional<Mount> Bridge::newest_mount() const {
  if (!config_.uses_transforms) return config_.mount;
  if (sensor_frame_.empty()) return std::nullopt;
  const auto body_from_sensor = transforms_.newest(body_frame_, sensor_frame_);
  if (!body_from_sensor) return std::nullopt;
  return Mount(body_from_sensor->target_from_source, config_.mount.axes());
}

bool Bridge::has_arrived(const PoseState& pose_state) const {
  if (pose_state.body.state != PoseMatch::State::known) return false;
  const Isometry3d optical = pose_state.mount.world_from_optical(pose_state.body.pose);
  const Vector3d axis = optical.linear().col(2), target = view_->linear().col(2);
  return (optical.translation() - view_->translation()).norm() <= config_.position_tolerance &&
         std::atan2(axis.cross(target).norm(), axis.dot(target)) <= config_.direction_tolerance;
}

/// Returns true if the sensor was within the tolerances during the whole settling time before the
/// stamp. Checks regular steps and all odometry poses. Throws Error{bad_geometry} if no pose was
/// elsewhere, but some are unknown.
bool Bridge::has_settled(Stamp stamp) const {
  const auto settling = static_cast<Stamp>(config_.settling * 1e9);
  std::string gap;
  const auto is_elsewhere = [&](const PoseState& found) {
    const bool is_known = found.body.state == PoseMatch::State::known;
    if (!is_known && gap.empty()) gap = found.body.reason;
    return is_known && !has_arrived(found);
  };
  constexpr Stamp steps = 10;
  for (Stamp step = 1; step <= steps; ++step) {
    if (is_elsewhere(at(stamp - settling * step / steps))) return false;
  }
  const auto is_there = [&](Stamp then, const BodyPose& pose) {
    return !is_elsewhere(with_mount({PoseMatch::State::known, pose, {}}, then));
  };
  if (config_.world.empty() && !history_.all_between(stamp - settling, stamp, is_there)) {
    return false;
  }
  if (gap.empty()) return true;
  throw Error(ErrorKind::bad_geometry,
              "ignored: sensor position unknown during the settling time: " + gap);
}

void Bridge::proceed(double now) {
  if (lacks_mount_ && newest_mount()) publish_goal();
  if (waiting_) {
    guarded("scan", now, [&] {
      const PoseState found = at(waiting_->stamp);
      const bool waits_more = now - waiting_->since <= config_.patience;
      if (found.body.state == PoseMatch::State::open && waits_more) return;
      const Waiting waiting = *std::exchange(waiting_, std::nullopt);
      if (found.body.state != PoseMatch::State::known) {
        throw Error(ErrorKind::bad_geometry, "its pose is unknown: " + found.body.reason);
      }
      submit_scan(waiting, found, now);
    });
  }
  constexpr double longest_silence = 2.0;
  if (is_finished_ || now - asked_at_ < longest_silence) return;
  asked_at_ = now;
  survey_.next();
}

/// Returns true if the survey accepts scans en route.
bool Bridge::measures_en_route() const {
  return answer_.contains("en_route") && view_ && answer_.at("scans").get<std::size_t>() > 0;
}

void Bridge::submit_scan(const Waiting& waiting, const PoseState& pose_state, double now) {
  auto from = skycap_live::From::view;
  if (config_.taking == Taking::arrived && view_) {
    const bool is_there = has_arrived(pose_state);
    if (!is_there && measures_en_route()) {
      from = skycap_live::From::en_route;
      const auto period = static_cast<Stamp>(1e9 * answer_.at("frame_period_s").get<double>());
      if (!is_add_requested_ && waiting.stamp - last_added_ < period) return;
    } else if (!is_add_requested_ && !(is_there && has_settled(waiting.stamp))) {
      return;
    }
  }
  set_status("planning");
  doing_ = "waiting for a scan";
  is_add_requested_ = false;
  const auto& [body, mount] = pose_state;
  const auto covariance =
      config_.uses_covariance ? mount.covariance_at_sensor(body.pose) : std::optional<Covariance>();
  const std::string answer = survey_.add(waiting.scan, to_rows(mount.world_from_optical(body.pose)),
                                         to_pose_error(covariance), from);
  last_added_ = waiting.stamp;
  ++added_scans_;
  asked_at_ = now;
  learn(answer, from);
  if (!is_suspended_) return;
  warn_throttled("pose",
                 "scan rejected: pose inconsistent with the map. Hold position, correct the pose "
                 "and send the command 'take'",
                 now);
}

void Bridge::receive(const String& command, double now) {
  guarded("command", now, [&] { obey(printable_text(command.data)); });
}

void Bridge::obey(const std::string& command) {
  const std::string reject = "refuse ";
  if (command == "take") {
    is_add_requested_ = true;
  } else if (command == "finish") {
    survey_.finish();
    is_finished_ = true;
    set_status("finished");
  } else if (command.starts_with(reject)) {
    learn(survey_.reject(answer_.at("id").get<std::size_t>(),
                         escaped(command.substr(reject.size()))));
  } else {
    throw Error(ErrorKind::bad_usage,
                "unknown command '" + command + "'; expected take, refuse REASON or finish");
  }
}

void Bridge::learn(const std::string& answer, skycap_live::From from) {
  const bool held = is_suspended_;
  answer_ = Json::parse(answer);
  view_.reset();
  if (const Json& view = answer_.at("view"); !view.is_null()) view_ = parse_view(view);
  is_suspended_ = answer_.contains("warning");
  // An en-route scan does not change the goal.
  const bool is_new = from == skycap_live::From::view || is_suspended_ != held;
  if (is_located_ && is_new) publish_goal();
  publish_status();
}

Stamp Bridge::newest_stamp() const {
  if (config_.world.empty()) return newest_pose_;
  const auto newest = transforms_.newest(world_frame_, body_frame_);
  return newest ? newest->stamp : 0;
}

void Bridge::publish_goal() {
  Goal goal{.frame = world_frame_,
            .stamp = newest_stamp(),
            .view = {},
            .path = {},
            .mount = newest_mount()};
  lacks_mount_ = !goal.mount;
  if (!is_suspended_) {
    goal.view = view_;
    for (const Json& position : answer_.value("path", Json::array())) {
      goal.path.push_back(to_vector(position));
    }
  }
  callbacks_.goal(goal);
}

void Bridge::set_status(const std::string& doing) {
  doing_ = doing;
  publish_status();
}

void Bridge::publish_status() {
  Json status{{"doing", is_suspended_ ? "holding: pose inconsistent with the map" : doing_},
              {"hold", is_suspended_},
              {"taken", added_scans_},
              {"warnings", warnings_.count()},
              {"last_warning", warnings_.last()}};
  for (const char* key : {"id", "state", "scans", "points", "rejected", "view", "clearance_m",
                          "en_route", "estimated_coverage", "pose"}) {
    if (answer_.contains(key)) status[key] = answer_[key];
  }
  const std::string text = status.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (std::exchange(status_, text) != text) callbacks_.status(text);
}

}  // namespace skycap::ros2
