/// Lists of the TUM layout: a time and what was then, line by line.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry/error.h"

namespace skycap::missions::online {

struct Stamped {
  double time = 0.0;  ///< [s]
  std::string time_text, rest;
};

struct StampedList {
  std::vector<Stamped> lines;      ///< times ascend
  std::vector<std::string> notes;  ///< what was not taken as it stands in the file
};

/// The lines of a list that are not comments. Of lines of one time, which trackers write when they
/// correct a pose, the last counts. Throws Error{bad_file} with file and line if times descend.
StampedList read_list(const std::filesystem::path& file);

/// The pose of a trajectory, `x y z qx qy qz qw` behind each time, that is nearest to a time.
/// Throws Error{bad_file} naming `file` if it is none, or more than 20 ms off.
Eigen::Isometry3d pose_at(std::span<const Stamped> poses, double time, const std::string& file);

/// The item whose `time` is nearest; times ascend. Throws Error{bad_file}, which `what` opens, if
/// it is more than 20 ms off.
template <typename Item>
const Item& nearest_pose(std::span<const Item> items, double time, const std::string& what) {
  constexpr double most_apart = 0.02;  // [s]
  const std::string complaint = what + ": no pose within 20 ms of its time";
  if (items.empty()) throw Error(ErrorKind::bad_file, complaint);
  auto near = std::ranges::lower_bound(items, time, {}, &Item::time);
  const bool is_last = near == items.end();
  if (near != items.begin() && (is_last || time - std::prev(near)->time <= near->time - time)) {
    --near;
  }
  const double apart = std::abs(near->time - time);
  if (apart <= most_apart) return *near;
  throw Error(ErrorKind::bad_file,
              fmt::format("{} (the nearest is {:.3f} s off)", complaint, apart));
}

}  // namespace skycap::missions::online
