#include "geometry/io/record_log.h"

#include <array>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <optional>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <zlib.h>

#include "geometry/error.h"
#include "geometry/io/file.h"

namespace skycap::geometry {
namespace {

constexpr std::size_t digits = 8;
constexpr std::size_t largest_log = std::size_t{1} << 30;

template <typename Number>
std::optional<Number> whole_number_in(std::string_view text, int base) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

struct Record {
  std::size_t number;
  std::string_view text;
};

/// Parses a line without its line end. Returns nullopt if the record is damaged.
std::optional<Record> parse_record(std::string_view line) {
  const auto stated = whole_number_in<std::uint32_t>(line.substr(0, digits), 16);
  if (!stated || line.size() < digits + 1 || line[digits] != ' ') return std::nullopt;
  line.remove_prefix(digits + 1);
  const std::size_t blank = line.find(' ');
  if (blank == std::string_view::npos || compute_crc32(line) != *stated) return std::nullopt;
  const auto number = whole_number_in<std::size_t>(line.substr(0, blank), 10);
  if (!number) return std::nullopt;
  return Record{*number, line.substr(blank + 1)};
}

std::string format_line(const Record& record) {
  const std::string text = std::to_string(record.number).append(" ").append(record.text);
  std::array<char, digits + 1> head{};
  std::snprintf(head.data(), head.size(), "%08x", static_cast<unsigned>(compute_crc32(text)));
  return std::string(head.data()).append(" ").append(text).append("\n");
}

/// Returns whether any of the lines is a valid record.
bool has_record(std::string_view lines) {
  while (!lines.empty()) {
    const std::size_t end = lines.find('\n');
    if (end == std::string_view::npos) return false;
    if (parse_record(lines.substr(0, end))) return true;
    lines.remove_prefix(end + 1);
  }
  return false;
}

RecordedLines records_in(std::string_view bytes, const std::filesystem::path& file) {
  RecordedLines found;
  while (found.whole_bytes < bytes.size()) {
    const std::string_view rest = bytes.substr(found.whole_bytes);
    const std::size_t end = rest.find('\n'), number = found.records.size() + 1;
    const auto record =
        end == std::string_view::npos ? std::nullopt : parse_record(rest.substr(0, end));
    if (!record && !has_record(rest)) {
      found.torn_bytes = rest.size();
      break;
    }
    if (!record || record->number != number) {
      throw Error(ErrorKind::bad_file,
                  file.string() + ": line " + std::to_string(number) +
                      " is damaged and is not the last line; restore the file from a copy");
    }
    found.records.emplace_back(record->text);
    found.whole_bytes += end + 1;
  }
  return found;
}

std::string read_bytes(const std::filesystem::path& file) {
  return std::filesystem::exists(file) ? read_file(file, largest_log) : std::string();
}

}  // namespace

std::uint32_t compute_crc32(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

RecordedLines read_records(const std::filesystem::path& file) {
  return records_in(read_bytes(file), file);
}

RecordLog::RecordLog(std::filesystem::path file) : file_(std::move(file)) {
  const bool is_new = !std::filesystem::exists(file_);
  handle_ = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (handle_ < 0) fail("cannot be opened for writing: " + std::generic_category().message(errno));
  try {
    if (::flock(handle_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      fail("is being written by another skycap process; wait for it to finish");
    }
    found_ = records_in(read_bytes(file_), file_);
    size_ = found_.whole_bytes;
    count_ = found_.records.size();
    if (found_.torn_bytes > 0) cut(size_);
    if (is_new) sync_to_disk(file_.has_parent_path() ? file_.parent_path() : ".");
  } catch (const Error&) {
    ::close(handle_);
    throw;
  }
}

RecordLog::~RecordLog() { ::close(handle_); }

void RecordLog::fail(const std::string& what) const {
  throw Error(ErrorKind::bad_file, file_.string() + ": " + what);
}

void RecordLog::cut(std::size_t size) {
  if (::ftruncate(handle_, static_cast<off_t>(size)) == 0) return;
  fail("cannot be truncated to its complete records: " + std::generic_category().message(errno));
}

void RecordLog::clear() {
  cut(0);
  found_ = {};
  size_ = count_ = 0;
}

void RecordLog::append(std::string_view text) {
  assert(text.find('\n') == std::string_view::npos);
  const std::string line = format_line({count_ + 1, text});
  std::string_view rest = line;
  bool is_written = true;
  while (is_written && !rest.empty()) {
    const ssize_t count = ::write(handle_, rest.data(), rest.size());
    if (count > 0) rest.remove_prefix(static_cast<std::size_t>(count));
    is_written = count >= 0 || errno == EINTR;
  }
  if (!is_written || ::fsync(handle_) != 0) {
    const std::string reason = std::generic_category().message(errno);
    cut(size_);
    fail("cannot be written: " + reason);
  }
  size_ += line.size();
  ++count_;
}

}  // namespace skycap::geometry
