#include "geometry/io/las/byte_window.h"

#include <algorithm>

#include "geometry/error.h"

namespace skycap::geometry::las {

void refuse(const std::string& sentence) { throw Error(ErrorKind::bad_file, sentence); }

void ByteWindow::take(char* bytes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<char>(next());
}

ByteWindow ByteWindow::part(std::uint64_t begin, std::uint64_t count) const {
  if (begin > end_ || count > end_ - begin) {
    refuse("has compressed points that are damaged: the part at byte " + std::to_string(begin) +
           " does not end within its chunk");
  }
  return {*read_, begin, begin + count};
}

void ByteWindow::read_piece() {
  constexpr std::uint64_t longest_piece = 1 << 16;
  piece_.clear();
  position_ = 0;
  if (unread_ < end_) piece_ = (*read_)(unread_, std::min(longest_piece, end_ - unread_));
  if (piece_.empty()) {
    refuse("has compressed points that are damaged: their bytes end at byte " +
           std::to_string(unread_) + ", within a point");
  }
  unread_ += piece_.size();
}

}  // namespace skycap::geometry::las
