#include "missions/online/recordings/stamped_list.h"

#include <utility>

#include "geometry/io/file.h"
#include "geometry/io/text/text_scanner.h"
#include "geometry/text_parts.h"
#include "missions/online/live/scan_input.h"

namespace skycap::missions::online {

StampedList read_list(const std::filesystem::path& file) {
  constexpr std::size_t largest = std::size_t{1} << 28;  // [bytes]
  const std::string name = file.string(), text = geometry::read_file(file, largest);
  StampedList list;
  std::size_t repeated = 0;
  geometry::TextScanner scanner(name, geometry::without_mark(text));
  do {
    const auto word = scanner.word_in_line();
    if (!word || word->starts_with('#')) continue;
    const auto time = scanner.number<double>(word, "a time");
    const bool is_same = !list.lines.empty() && time == list.lines.back().time;
    const bool is_later = list.lines.empty() || time > list.lines.back().time;
    if (!std::isfinite(time) || !(is_same || is_later)) {
      scanner.fail("time " + std::string(*word) +
                   " is not later than the previous one; sort the list");
    }
    std::string rest;
    while (const auto more = scanner.word_in_line()) {
      rest += (rest.empty() ? "" : " ") + std::string(*more);
    }
    if (is_same) list.lines.pop_back(), ++repeated;
    list.lines.push_back({time, std::string(*word), std::move(rest)});
  } while (scanner.next_line());
  if (repeated > 0) {
    list.notes.push_back(fmt::format(
        "{}: lines ignored because a later line has the same timestamp: {}", name, repeated));
  }
  return list;
}

Eigen::Isometry3d pose_at(std::span<const Stamped> poses, double time, const std::string& file) {
  const Stamped& pose = nearest_pose(poses, time, file);
  return parse_pose_text(pose.rest, file + ": time " + pose.time_text);
}

}  // namespace skycap::missions::online
