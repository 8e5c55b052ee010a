/// Pages of an E57 file (ASTM E2807-11, section 6). Each page ends with a 4-byte big-endian
/// checksum. Physical offsets count the checksums; logical offsets do not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace skycap::geometry::e57 {

inline constexpr std::size_t page_size = 1024;  ///< page size of written files [bytes]
inline constexpr std::size_t checksum_size = 4;
inline constexpr std::size_t page_content = page_size - checksum_size;

/// Returns `count` bytes from offset `offset`, or fewer at the end of the file.
using ReadBytes = std::function<std::string(std::uint64_t offset, std::uint64_t count)>;

/// Throws Error{bad_file}. Callers that know the file name prepend it to the message.
[[noreturn]] void throw_bad_file(const std::string& sentence);

/// File header, which contains no checksum.
struct FileHeader {
  std::uint64_t file_size = 0;    ///< [bytes]
  std::uint64_t description = 0;  ///< physical offset of the XML section
  std::uint64_t description_size = 0;
  std::uint64_t page_size = 0;
};

/// Parses the file header. Throws Error{bad_file} if it is invalid for a file of `file_size` bytes.
FileHeader parse_file_header(std::string_view beginning, std::uint64_t file_size);

/// Logical byte stream of a file. The checksum of each page is verified when the page is read.
class Pages {
 public:
  Pages(ReadBytes read, const FileHeader& header);

  std::uint64_t size() const {
    return file_size_ / page_size_ * content_;
  }  ///< logical size [bytes]

  /// Converts a physical to a logical offset. Throws Error{bad_file} if the offset is outside the
  /// file or inside a checksum; `what` names the object at the offset in the message.
  std::uint64_t logical(std::uint64_t physical, const std::string& what) const;

  /// Returns exactly `count` bytes from logical offset `offset`; the range must lie within the
  /// file. Throws Error{bad_file} if a page does not match its checksum.
  std::string bytes(std::uint64_t offset, std::uint64_t count);

 private:
  void read_window(std::uint64_t offset);

  ReadBytes read_;
  std::uint64_t file_size_, page_size_, content_;
  std::string window_;  ///< contents of consecutive pages
  std::uint64_t window_begin_ = 0;
};

/// Splits content into pages with checksums, incrementally.
class PageWriter {
 public:
  PageWriter() = default;
  /// Resumes a page with the content `open_page` that has no checksum yet.
  explicit PageWriter(std::string open_page) : open_(std::move(open_page)) {}

  /// Returns the bytes to append to the file: the content, with a checksum at each page end.
  std::string continued(std::string_view content);
  /// Returns the zero padding and the checksum that complete the last page.
  std::string closed();

 private:
  std::string open_;  ///< content of the current page, which has no checksum yet
};

/// Returns pages with this content. The last page is padded with zeros.
std::string sealed(std::string_view content);

}  // namespace skycap::geometry::e57
