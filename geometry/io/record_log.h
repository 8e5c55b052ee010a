/// A file that only ever grows, record by record, and survives a kill or a power cut at any moment:
/// what append() has returned from is there for good, and what it has not is not there at all.
///
/// A record is a line: eight hexadecimal digits, a blank, the record's number, counted from one, a
/// blank, its text. The digits are the CRC-32 (IEEE 802.3) of number, blank and text, so that a
/// record that was changed, moved or taken out is noticed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::geometry {

/// What a file of records holds.
struct RecordedLines {
  std::vector<std::string> records;
  std::size_t whole_bytes = 0;  ///< of the file, that the records take
  std::size_t torn_bytes = 0;   ///< behind them: what a kill has left of a record
};

/// CRC-32 as in zlib and PNG.
std::uint32_t crc32_of(std::string_view bytes);

/// Reads the records of a file; none if there is no such file. Throws Error{bad_file} naming the
/// line if a record is damaged and sound ones follow: that is no interrupted writing.
RecordedLines read_records(const std::filesystem::path& file);

/// The one writer of a file of records.
class RecordLog {
 public:
  /// Opens the file, or makes it, reads what it holds and cuts off what is torn. Throws
  /// Error{bad_file} if that fails, as read_records() does, or if another program is at it.
  explicit RecordLog(std::filesystem::path file);
  RecordLog(const RecordLog&) = delete;
  RecordLog& operator=(const RecordLog&) = delete;
  ~RecordLog();

  const std::filesystem::path& file() const { return file_; }
  /// Those that were there when the file was opened.
  const std::vector<std::string>& records() const { return found_.records; }

  /// Brings a record to the disk before it returns. The text must not hold a line end. Throws
  /// Error{bad_file} if it cannot; the file is then as before.
  void append(std::string_view text);

 private:
  void cut(std::size_t size);
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path file_;
  RecordedLines found_;
  int handle_ = -1;
  std::size_t size_ = 0;   ///< of the file [byte]
  std::size_t count_ = 0;  ///< records in it
};

}  // namespace skycap::geometry
