#include "missions/live/recorded_sequence.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/text_scanner.h"
#include "missions/live/scan_input.h"

namespace skycap::missions::live {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_list = std::size_t{1} << 28, largest_pose = 1 << 16;  // [byte]

/// A line of a list of the TUM layout.
struct Stamped {
  double time;
  std::string time_text, rest;
};

/// The lines of a list that are not comments, times ascending.
std::vector<Stamped> read_list(const fs::path& file) {
  const std::string name = file.string(), text = geometry::read_file(file, largest_list);
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

const Stamped* nearest(const std::vector<Stamped>& lines, double time) {
  const auto after = std::ranges::lower_bound(lines, time, {}, &Stamped::time);
  if (after == lines.begin()) return lines.empty() ? nullptr : &lines.front();
  const auto before = std::prev(after);
  return after == lines.end() || time - before->time <= after->time - time ? &*before : &*after;
}

/// Adds the frame with the pose that `pose` reads, or a note that says why not.
template <typename Pose>
void add_frame(RecordedSequence& sequence, const std::string& id, const fs::path& file, Pose pose) {
  try {
    if (!fs::exists(file)) throw Error(ErrorKind::bad_file, file.string() + ": is not there");
    sequence.frames.push_back({.id = id, .file = file, .world_from_sensor = pose()});
  } catch (const Error& failure) {
    sequence.notes.push_back(id + " is left out: " + failure.what());
  }
}

RecordedSequence read_tum(const fs::path& folder, std::size_t count) {
  constexpr double most_apart = 0.02;  // [s]
  const fs::path poses_file = folder / "groundtruth.txt";
  const std::vector<Stamped> images = read_list(folder / "depth.txt");
  const std::vector<Stamped> poses = read_list(poses_file);
  RecordedSequence sequence;
  for (std::size_t i = 0; i < std::min(count, images.size()); ++i) {
    const Stamped& image = images[i];
    add_frame(sequence, image.time_text, folder / image.rest, [&] {
      const Stamped* pose = nearest(poses, image.time);
      const double apart = pose == nullptr ? most_apart : std::abs(pose->time - image.time);
      if (pose == nullptr || apart > most_apart) {
        throw Error(
            ErrorKind::bad_file,
            poses_file.string() + ": has no pose within 20 ms of its time" +
                (pose == nullptr ? "" : fmt::format(" (the nearest is {:.3f} s off)", apart)));
      }
      return parse_pose_text(pose->rest, poses_file.string() + ": time " + pose->time_text);
    });
  }
  return sequence;
}

constexpr std::string_view image_ending = ".depth.png";

/// The images of the 7-Scenes layout, by name.
std::vector<fs::path> numbered_images(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("frame-") && name.ends_with(image_ending)) images.push_back(entry.path());
  }
  std::ranges::sort(images);
  return images;
}

RecordedSequence read_numbered(const std::vector<fs::path>& images, std::size_t count) {
  RecordedSequence sequence;
  for (std::size_t i = 0; i < std::min(count, images.size()); ++i) {
    const std::string name = images[i].filename().string();
    const std::string id = name.substr(0, name.size() - image_ending.size());
    add_frame(sequence, id, images[i], [&] {
      const fs::path pose = images[i].parent_path() / (id + ".pose.txt");
      return parse_pose_text(geometry::read_file(pose, largest_pose), pose.string());
    });
  }
  return sequence;
}

}  // namespace

RecordedSequence read_sequence(const fs::path& folder, std::size_t count) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorKind::bad_file, folder.string() + ": " + why);
  };
  if (!fs::is_directory(folder)) refuse("is no folder; name the one of a recording");
  RecordedSequence sequence;
  if (fs::exists(folder / "depth.txt")) {
    sequence = read_tum(folder, count);
  } else {
    sequence = read_numbered(numbered_images(folder), count);
  }
  if (!sequence.frames.empty()) return sequence;
  if (!sequence.notes.empty()) refuse("has no usable frame; " + sequence.notes.front());
  refuse(
      "has neither depth.txt and groundtruth.txt (TUM RGB-D) nor frame-NNNNNN.depth.png with "
      "frame-NNNNNN.pose.txt (7-Scenes)");
  return sequence;
}

}  // namespace skycap::missions::live
