#include "missions/online/recordings/rawlog_stream.h"

#include <algorithm>

#include "geometry/error.h"

namespace skycap::missions::online {

RawlogBytes::RawlogBytes(const std::filesystem::path& file) : file_(gzopen(file.c_str(), "rb")) {
  if (file_ == nullptr) {
    throw Error(ErrorKind::bad_file, file.string() + ": cannot be opened");
  }
}

RawlogBytes::~RawlogBytes() { gzclose(file_); }

std::size_t RawlogBytes::read(void* buffer, std::size_t count) {
  constexpr std::size_t max = std::size_t{1} << 30;  // zlib counts bytes with int.
  auto* to = static_cast<char*>(buffer);
  std::size_t done = 0;
  while (done < count) {
    const int got = gzread(file_, to + done, static_cast<unsigned>(std::min(count - done, max)));
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  position_ += done;
  return done;
}

std::string RawlogBytes::damage() const {
  int code = Z_OK;
  const char* const what = gzerror(file_, &code);
  return code == Z_OK || code == Z_STREAM_END ? "" : what;
}

}  // namespace skycap::missions::online
