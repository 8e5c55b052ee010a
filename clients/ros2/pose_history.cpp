#include "clients/ros2/pose_history.h"

#include <algorithm>
#include <cstdio>
#include <iterator>

#include "geometry/error.h"

namespace skycap::ros2 {
namespace {

constexpr double seconds_per_nanosecond = 1e-9;

std::string rounded(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3g %s", value, unit);
  return text;
}

BodyPose between(const BodyPose& a, const BodyPose& b, double share) {
  BodyPose pose{.position = a.position + share * (b.position - a.position),
                .turn = a.turn.slerp(share, b.turn),
                .covariance = {}};
  if (a.covariance && b.covariance) {
    pose.covariance = (1.0 - share) * *a.covariance + share * *b.covariance;
  }
  return pose;
}

}  // namespace

Stamp to_stamp(const Header& header) {
  if (header.stamp.nanosec >= 1'000'000'000U) {
    throw Error(ErrorKind::bad_geometry,
                "the nanoseconds of its timestamp must be less than 1,000,000,000");
  }
  const Stamp stamp = Stamp{header.stamp.sec} * 1'000'000'000 + header.stamp.nanosec;
  if (stamp <= 0) throw Error(ErrorKind::bad_geometry, "its timestamp is not set");
  return stamp;
}

PoseHistory::Added PoseHistory::add(Stamp stamp, const BodyPose& pose) {
  const auto [entry, is_new] = poses_.try_emplace(stamp, pose);
  if (!is_new) {
    const BodyPose& kept = entry->second;
    const bool is_same = kept.position == pose.position && kept.turn.coeffs() == pose.turn.coeffs();
    return is_same ? Added::known : Added::contradicts;
  }
  arrivals_.push_back(stamp);
  if (arrivals_.size() > config_.max) {
    poses_.erase(arrivals_.front());
    arrivals_.pop_front();
  }
  return Added::accepted;
}

PoseMatch PoseHistory::at(Stamp stamp) const {
  using enum PoseMatch::State;
  const auto after = poses_.lower_bound(stamp);
  if (after != poses_.end() && after->first == stamp) return {known, after->second, {}};
  const double to_after = after == poses_.end()
                              ? config_.longest_gap + 1.0
                              : static_cast<double>(after->first - stamp) * seconds_per_nanosecond;
  if (to_after > config_.longest_gap) {
    return {open, {}, "no pose within " + rounded(config_.longest_gap, "s") + " after it"};
  }
  const double from_before =
      after == poses_.begin()
          ? config_.longest_gap + 1.0
          : static_cast<double>(stamp - std::prev(after)->first) * seconds_per_nanosecond;
  if (from_before > config_.longest_gap) {
    return {open, {}, "no pose within " + rounded(config_.longest_gap, "s") + " before it"};
  }
  const BodyPose &a = std::prev(after)->second, &b = after->second;
  const double time = from_before + to_after;
  const double speed = (b.position - a.position).norm() / time;
  const double turn = a.turn.angularDistance(b.turn) / time;
  if (speed > config_.max_speed || turn > config_.max_turn_rate) {
    return {rejected,
            {},
            "it jumps at an implausible speed of " + rounded(speed, "m/s") + " and " +
                rounded(turn, "rad/s")};
  }
  return {known, between(a, b, from_before / time), {}};
}

bool PoseHistory::all_between(Stamp from, Stamp to,
                              const std::function<bool(Stamp, const BodyPose&)>& holds) const {
  return std::all_of(poses_.lower_bound(from), poses_.upper_bound(to),
                     [&](const auto& entry) { return holds(entry.first, entry.second); });
}

}  // namespace skycap::ros2
