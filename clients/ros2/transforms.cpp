#include "clients/ros2/transforms.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "clients/ros2/throttled_warnings.h"
#include "geometry/error.h"

namespace skycap::ros2 {
namespace {

[[noreturn]] void reject(const std::string& what) { throw Error(ErrorKind::bad_geometry, what); }

std::string checked_frame_name(const char* text, const std::string& what) {
  if (text == nullptr || *text == '\0') reject("the " + what + " frame of a transform has no name");
  // printable_text() truncates longer names, which could then collide.
  constexpr std::size_t longest = 100;
  if (::strnlen(text, longest + 1) > longest) {
    reject("the name of the " + what + " frame of a transform is longer than 100 bytes");
  }
  return printable_text(text);
}

/// Returns the pose of c in a, from b in a and c in b.
BodyPose chained(const BodyPose& a, const BodyPose& b) {
  return {.position = a.position + a.turn * b.position,
          .turn = (a.turn * b.turn).normalized(),
          .covariance = {}};
}

BodyPose inverse(const BodyPose& pose) {
  const Eigen::Quaterniond turn = pose.turn.conjugate();
  return {.position = -(turn * pose.position), .turn = turn, .covariance = {}};
}

}  // namespace

Transforms::Transforms(HistoryConfig config) : config_(config) { config_.max = max_poses; }

void Transforms::add(const TransformStamped& transform, bool is_static) {
  const std::string parent = checked_frame_name(transform.header.frame_id, "parent");
  const std::string name = checked_frame_name(transform.child_frame_id, "child");
  const std::string what = "the frame '" + name + "'";
  if (parent == name) reject(what + " is its own parent");
  const BodyPose pose = body_pose(transform.transform);
  const Stamp stamp = is_static ? 0 : to_stamp(transform.header);
  auto known = frames_.find(name);
  if (known == frames_.end()) {
    if (frames_.size() >= max_frames) reject("more than " + std::to_string(max_frames) + " frames");
    Frame frame{.parent = parent,
                .fixed = {},
                .history = PoseHistory(config_),
                .last = pose,
                .last_stamp = stamp};
    if (is_static) frame.fixed = pose;
    known = frames_.emplace(name, std::move(frame)).first;
  }
  Frame& frame = known->second;
  if (frame.parent != parent) {
    reject(what + " has the parent '" + parent + "'; it must remain '" + frame.parent + "'");
  }
  if (frame.fixed.has_value() != is_static) reject(what + " must not be both static and moving");
  if (is_static) {
    frame.fixed = pose;
  } else if (frame.history.add(stamp, pose) == PoseHistory::Added::contradicts) {
    reject(what + " has two different poses for the same timestamp");
  }
  frame.last = pose;
  frame.last_stamp = stamp;
}

PoseMatch Transforms::in_parent(const Frame& frame, std::optional<Stamp> stamp) {
  if (frame.fixed) return {PoseMatch::State::known, *frame.fixed, {}};
  if (!stamp) return {PoseMatch::State::known, frame.last, {}};
  return frame.history.at(*stamp);
}

Transforms::Found Transforms::find(const std::string& target, const std::string& source,
                                   std::optional<Stamp> stamp) const {
  // Returns the frame names from `name` up to the root.
  const auto up_from = [this](std::string name) {
    std::vector<std::string> names{name};
    for (auto frame = frames_.find(name); frame != frames_.end();
         frame = frames_.find(names.back())) {
      if (static_cast<int>(names.size()) > longest_chain) return std::vector<std::string>();
      names.push_back(frame->second.parent);
    }
    return names;
  };
  using enum PoseMatch::State;
  const std::vector<std::string> up = up_from(source), down = up_from(target);
  if (up.empty() || down.empty()) {
    return {{rejected,
             {},
             "the frames above '" + source + "' and '" + target +
                 "' form a loop or a chain of more than 64 frames"}};
  }
  const auto meeting = std::ranges::find_first_of(up, down);
  if (meeting == up.end()) {
    return {{open, {}, "no transforms lead from '" + target + "' to '" + source + "'"}};
  }
  Found found;
  const auto climb = [&](const std::vector<std::string>& names) {
    PoseMatch match{known, {}, {}};
    for (const std::string& name : names) {
      if (name == *meeting) break;
      const Frame& frame = frames_.at(name);
      found.newest = std::max(found.newest, frame.last_stamp);
      const PoseMatch step = in_parent(frame, stamp);
      if (step.state != known)
        return PoseMatch{step.state, {}, "frame '" + name + "': " + step.reason};
      match.pose = chained(step.pose, match.pose);
    }
    return match;
  };
  const PoseMatch source_match = climb(up), target_match = climb(down);
  if (source_match.state != known) return {source_match};
  if (target_match.state != known) return {target_match};
  found.match = {known, chained(inverse(target_match.pose), source_match.pose), {}};
  return found;
}

PoseMatch Transforms::at(const std::string& target, const std::string& source, Stamp stamp) const {
  return find(target, source, stamp).match;
}

std::optional<NewestTransform> Transforms::newest(const std::string& target,
                                                  const std::string& source) const {
  const Found found = find(target, source, std::nullopt);
  if (found.match.state != PoseMatch::State::known) return std::nullopt;
  return NewestTransform{to_isometry(found.match.pose), found.newest};
}

}  // namespace skycap::ros2
