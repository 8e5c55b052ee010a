#include "geometry/io/las/byte_window.h"

#include <algorithm>

#include "geometry/error.h"

namespace skycap::geometry::las {

void throw_bad_file(const std::string& sentence) { throw Error(ErrorKind::bad_file, sentence); }

void ByteWindow::take(char* bytes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<char>(next());
}

ByteWindow ByteWindow::part(std::uint64_t begin, std::uint64_t count) const {
  if (begin > end_ || count > end_ - begin) {
    throw_bad_file("has damaged compressed points: the section at byte " + std::to_string(begin) +
                   " extends beyond its chunk");
  }
  return {*read_, begin, begin + count};
}

void ByteWindow::read_chunk() {
  constexpr std::uint64_t max_chunk_bytes = 1 << 16;
  chunk_.clear();
  position_ = 0;
  if (unread_ < end_) chunk_ = (*read_)(unread_, std::min(max_chunk_bytes, end_ - unread_));
  if (chunk_.empty()) {
    throw_bad_file("has damaged compressed points: the data end at byte " +
                   std::to_string(unread_) + ", inside a point");
  }
  unread_ += chunk_.size();
}

}  // namespace skycap::geometry::las
