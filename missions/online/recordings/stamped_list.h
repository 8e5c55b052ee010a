/// Lists in TUM layout: a time and further values in each line.
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
  std::vector<Stamped> lines;      ///< Lines in ascending order of time.
  std::vector<std::string> notes;  ///< Notes about lines that were not used unchanged.
};

/// Reads all lines of a list except comments. The last of several lines with the same time is used,
/// because trackers write them to correct a pose. Throws Error{bad_file} naming file and line if
/// times descend.
StampedList read_list(const std::filesystem::path& file);

/// Returns the trajectory pose nearest to `time` [s]. Lines have the form `time x y z qx qy qz qw`.
/// Throws Error{bad_file} naming `file` if the pose is invalid or more than 20 ms away.
Eigen::Isometry3d pose_at(std::span<const Stamped> poses, double time, const std::string& file);

/// Returns the item nearest to `time` [s]. Times must ascend. Throws Error{bad_file} with the
/// prefix `what` if it is more than 20 ms away.
template <typename Item>
const Item& nearest_pose(std::span<const Item> items, double time, const std::string& what) {
  constexpr double max_time_difference = 0.02;  // [s]
  const std::string error_message = what + ": no pose within 20 ms of its timestamp";
  if (items.empty()) throw Error(ErrorKind::bad_file, error_message);
  auto near = std::ranges::lower_bound(items, time, {}, &Item::time);
  const bool is_last = near == items.end();
  if (near != items.begin() && (is_last || time - std::prev(near)->time <= near->time - time)) {
    --near;
  }
  const double apart = std::abs(near->time - time);
  if (apart <= max_time_difference) return *near;
  throw Error(ErrorKind::bad_file,
              fmt::format("{} (the nearest is {:.3f} s off)", error_message, apart));
}

}  // namespace skycap::missions::online
