#include "missions/online/recordings/stamped_list.h"

#include <utility>

#include "geometry/io/file.h"
#include "geometry/io/text_scanner.h"
#include "missions/online/live/scan_input.h"

namespace skycap::missions::online {

std::vector<Stamped> read_list(const std::filesystem::path& file) {
  constexpr std::size_t largest = std::size_t{1} << 28;  // [byte]
  const std::string name = file.string(), text = geometry::read_file(file, largest);
  std::vector<Stamped> lines;
  geometry::TextScanner scanner(name, text);
  do {
    const auto word = scanner.word_in_line();
    if (!word || word->starts_with('#')) continue;
    const auto time = scanner.number<double>(word, "a time");
    if (!std::isfinite(time) || (!lines.empty() && !(time > lines.back().time))) {
      scanner.fail("time " + std::string(*word) + " is not after the one before; sort the list");
    }
    std::string rest;
    while (const auto more = scanner.word_in_line()) {
      rest += (rest.empty() ? "" : " ") + std::string(*more);
    }
    lines.push_back({time, std::string(*word), std::move(rest)});
  } while (scanner.next_line());
  return lines;
}

Eigen::Isometry3d pose_at(std::span<const Stamped> poses, double time, const std::string& file) {
  const Stamped& pose = nearest_pose(poses, time, file);
  return parse_pose_text(pose.rest, file + ": time " + pose.time_text);
}

}  // namespace skycap::missions::online
