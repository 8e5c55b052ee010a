#include "missions/site_data/formats/file_contents.h"

#include "geometry/error.h"

namespace skycap::missions::site_data {

std::string one_line(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return text;
}

void fail_file(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorKind::bad_file, file.string() + ": " + one_line(what));
}

void require_tree_fits(const std::filesystem::path& file, std::size_t bytes) {
  if (bytes > max_tree_bytes) {
    fail_file(file, "requires more than 2 GiB of memory; split the file");
  }
}

void note_skipped(std::size_t points, FileContents& contents) {
  if (points == 0) return;
  contents.notes.push_back(std::to_string(points) + " points skipped (NaN or infinite)");
}

void set_wkt(FileContents& contents, const std::string& wkt) {
  contents.is_local_frame = wkt.starts_with("LOCAL_CS[\"local east-north-up\"");
  if (!contents.is_local_frame) contents.crs = wkt;
}

}  // namespace skycap::missions::site_data
