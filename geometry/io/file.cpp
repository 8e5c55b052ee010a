#include "geometry/io/file.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <limits>
#include <system_error>

#include <unistd.h>
#include <zlib.h>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_file = std::size_t{4} << 30;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::bad_file, path.string() + ": " + what);
}

std::string last_error() { return std::generic_category().message(errno); }

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::string inflate_gzip(const fs::path& path, std::string_view bytes) {
  z_stream stream{};
  constexpr int gzip_only = 16 + MAX_WBITS;
  if (inflateInit2(&stream, gzip_only) != Z_OK) fail(path, "zlib cannot start");
  std::string inflated, chunk(1 << 20, '\0');
  int status = Z_OK;
  while (status == Z_OK || (status == Z_STREAM_END && !bytes.empty())) {
    if (status == Z_STREAM_END) inflateReset(&stream);  // gzip files may be concatenated
    const auto given = std::min<std::size_t>(bytes.size(), std::numeric_limits<uInt>::max());
    // zlib does not write to its input, but its C interface says so only on request.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(given);
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    status = inflate(&stream, Z_NO_FLUSH);
    bytes.remove_prefix(given - stream.avail_in);
    inflated.append(chunk, 0, chunk.size() - stream.avail_out);
    if (inflated.size() > largest_file) break;
  }
  inflateEnd(&stream);
  if (inflated.size() > largest_file) fail(path, "is larger than 4 GiB when decompressed");
  if (status != Z_STREAM_END) {
    fail(path, "is not a complete gzip file (damaged or cut short); obtain it again");
  }
  return inflated;
}

}  // namespace

std::string read_file(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) fail(path, "there is no such file");
  if (fs::is_directory(status)) fail(path, "is a directory; a file is wanted");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(path, "cannot be opened: " + last_error());
  std::string bytes;
  if (fs::is_regular_file(status)) {
    const auto size = fs::file_size(path, error);
    if (!error && size > largest_file) fail(path, "is larger than 4 GiB");
    if (!error) bytes.reserve(size);
  }
  std::string chunk(1 << 20, '\0');
  while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())),
         stream.gcount() > 0) {
    bytes.append(chunk, 0, static_cast<std::size_t>(stream.gcount()));
    if (bytes.size() > largest_file) fail(path, "is larger than 4 GiB");
  }
  if (stream.bad()) fail(path, "cannot be read: " + last_error());
  return is_gzip(bytes) ? inflate_gzip(path, bytes) : bytes;
}

void write_file(const fs::path& path, std::string_view bytes) {
  std::error_code unmade;  // a folder that is not there says so when the file is opened
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), unmade);
  fs::path temporary = path;
  temporary += ".tmp" + std::to_string(::getpid());
  std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
  if (!stream) fail(path, "cannot be written: " + last_error());
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  std::error_code error;
  if (stream) {
    fs::rename(temporary, path, error);
    if (!error) return;
  }
  const std::string why = error ? error.message() : last_error();
  std::error_code ignored;
  fs::remove(temporary, ignored);
  fail(path, "cannot be written: " + why);
}

}  // namespace skycap::geometry
