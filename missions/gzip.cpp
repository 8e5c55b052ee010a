#include "missions/gzip.h"

#include <array>
#include <fstream>
#include <memory>

#include <zlib.h>

#include "geometry/error.h"

namespace skycap::missions {

std::filesystem::path decompress_gzip(const std::filesystem::path& file) {
  const auto fail = [&](const char* what) {
    throw Error(ErrorKind::bad_file, file.string() + ": " + what);
  };
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> input(gzopen(file.c_str(), "rb"), gzclose);
  if (!input) fail("cannot be read");
  std::filesystem::path target = file;
  target.replace_extension();
  std::ofstream output(target, std::ios::binary);
  std::array<char, 1 << 16> buffer{};
  for (;;) {
    const int count = gzread(input.get(), buffer.data(), buffer.size());
    if (count < 0) fail("is not a whole gzip file");
    if (count == 0) break;
    output.write(buffer.data(), count);
  }
  int error = Z_OK;
  gzerror(input.get(), &error);
  if (error != Z_OK && error != Z_STREAM_END) fail("is not a whole gzip file");
  output.close();
  if (!output) fail("cannot be decompressed; is the disk full?");
  return target;
}

}  // namespace skycap::missions
