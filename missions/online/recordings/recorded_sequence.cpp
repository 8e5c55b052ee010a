#include "missions/online/recordings/recorded_sequence.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/online/live/scan_input.h"
#include "missions/online/recordings/stamped_list.h"

namespace skycap::missions::online {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_pose = 1 << 16;  // [bytes]

/// Adds a frame with the pose returned by `pose`, or a note with the reason for skipping it.
template <typename Pose>
void add_frame(RecordedSequence& sequence, const std::string& id, const fs::path& file, Pose pose) {
  try {
    if (!fs::exists(file)) throw Error(ErrorKind::bad_file, file.string() + ": does not exist");
    sequence.frames.push_back({.id = id, .file = file, .world_from_sensor = pose()});
  } catch (const Error& failure) {
    sequence.notes.push_back(id + " is skipped: " + failure.what());
  }
}

/// Returns the path of a list entry. Entries may be quoted or use Windows separators.
fs::path listed_file(const fs::path& folder, std::string name) {
  if (name.size() > 1 && name.front() == name.back() &&
      (name.front() == '"' || name.front() == '\'')) {
    name = name.substr(1, name.size() - 2);
  }
  if (fs::exists(folder / name)) return folder / name;
  std::ranges::replace(name, '\\', '/');
  return folder / name;
}

RecordedSequence read_tum(const fs::path& folder, std::size_t count) {
  const fs::path poses_file = folder / "groundtruth.txt";
  const StampedList image_list = read_list(folder / "depth.txt");
  const StampedList pose_list = read_list(poses_file);
  const std::vector<Stamped>&images = image_list.lines, &poses = pose_list.lines;
  RecordedSequence sequence;
  for (const StampedList* list : {&image_list, &pose_list}) {
    sequence.remarks.insert(sequence.remarks.end(), list->notes.begin(), list->notes.end());
  }
  for (std::size_t i = 0; i < std::min(count, images.size()); ++i) {
    const Stamped& image = images[i];
    add_frame(sequence, image.time_text, listed_file(folder, image.rest),
              [&] { return pose_at(poses, image.time, poses_file.string()); });
  }
  return sequence;
}

constexpr std::string_view image_suffix = ".depth.png";

/// Returns the images of the 7-Scenes layout, sorted by name.
std::vector<fs::path> numbered_images(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("frame-") && name.ends_with(image_suffix)) images.push_back(entry.path());
  }
  std::ranges::sort(images);
  return images;
}

RecordedSequence read_numbered(const std::vector<fs::path>& images, std::size_t count) {
  RecordedSequence sequence;
  for (std::size_t i = 0; i < std::min(count, images.size()); ++i) {
    const std::string name = images[i].filename().string();
    const std::string id = name.substr(0, name.size() - image_suffix.size());
    add_frame(sequence, id, images[i], [&] {
      const fs::path pose = images[i].parent_path() / (id + ".pose.txt");
      return parse_pose_text(geometry::read_file(pose, largest_pose), pose.string());
    });
  }
  return sequence;
}

}  // namespace

RecordedSequence read_sequence(const fs::path& folder, std::size_t count) {
  const auto reject = [&](const std::string& reason) {
    throw Error(ErrorKind::bad_file, folder.string() + ": " + reason);
  };
  if (!fs::is_directory(folder)) reject("is not a folder; specify the folder of a recording");
  RecordedSequence sequence;
  if (fs::exists(folder / "depth.txt")) {
    sequence = read_tum(folder, count);
  } else {
    sequence = read_numbered(numbered_images(folder), count);
  }
  if (!sequence.frames.empty()) return sequence;
  if (!sequence.notes.empty()) reject("has no usable frame; " + sequence.notes.front());
  reject(
      "contains neither depth.txt and groundtruth.txt (TUM RGB-D) nor frame-NNNNNN.depth.png with "
      "frame-NNNNNN.pose.txt (7-Scenes)");
  return sequence;
}

}  // namespace skycap::missions::online
