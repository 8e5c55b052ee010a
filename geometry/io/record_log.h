/// Append-only record file that survives kills and power failures. A record is durable once
/// append() has returned. An interrupted append leaves no record.
///
/// Each record is a line: eight hexadecimal digits, a space, the one-based record number, a space
/// and the text. The digits are the CRC-32 (IEEE 802.3) of the rest of the line, so that changed,
/// moved and missing records are detected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::geometry {

/// Content of a record file.
struct RecordedLines {
  std::vector<std::string> records;
  std::size_t whole_bytes = 0;  ///< bytes of complete records
  std::size_t torn_bytes = 0;   ///< bytes of an incomplete record at the end
};

/// Returns the CRC-32 used by zlib and PNG.
std::uint32_t compute_crc32(std::string_view bytes);

/// Reads the records of a file. Returns no records if the file does not exist. Throws
/// Error{bad_file} that names the line if a damaged record precedes valid ones, because an
/// interrupted write cannot cause that.
RecordedLines read_records(const std::filesystem::path& file);

/// Exclusive writer of a record file.
class RecordLog {
 public:
  /// Opens or creates the file, reads its records and truncates an incomplete last record. Throws
  /// Error{bad_file} if that fails, if read_records() does, or if another program has opened the
  /// file.
  explicit RecordLog(std::filesystem::path file);
  RecordLog(const RecordLog&) = delete;
  RecordLog& operator=(const RecordLog&) = delete;
  ~RecordLog();

  const std::filesystem::path& file() const { return file_; }
  /// Returns the records that existed when the file was opened.
  const std::vector<std::string>& records() const { return found_.records; }

  /// Appends a record and syncs it to disk. `text` must not contain line ends. If it throws
  /// Error{bad_file}, the file is unchanged.
  void append(std::string_view text);

  /// Removes all records. Throws Error{bad_file} if that fails.
  void clear();

 private:
  void cut(std::size_t size);
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path file_;
  RecordedLines found_;
  int handle_ = -1;
  std::size_t size_ = 0;   ///< file size [bytes]
  std::size_t count_ = 0;  ///< number of records
};

}  // namespace skycap::geometry
