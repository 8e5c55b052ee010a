/// The pages of an E57 file (ASTM E2807-11, 6): each ends with a checksum of 4 bytes, the highest
/// first. A place in the file is physical, one that does not count checksums is logical.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace skycap::geometry::e57 {

inline constexpr std::size_t page_size = 1024;  ///< of files that are written
inline constexpr std::size_t checksum_size = 4;
inline constexpr std::size_t page_content = page_size - checksum_size;

/// Bytes from a place of the file, fewer if it ends.
using ReadBytes = std::function<std::string(std::uint64_t place, std::uint64_t count)>;

/// Throws Error{bad_file}; who knows the file's name puts it before the sentence.
[[noreturn]] void refuse(const std::string& sentence);

/// What a file begins with, in bytes without a checksum between them.
struct FileHeader {
  std::uint64_t file_size = 0;    ///< [bytes]
  std::uint64_t description = 0;  ///< physical place of the XML
  std::uint64_t description_size = 0;
  std::uint64_t page_size = 0;
};

/// Throws Error{bad_file} unless a file of that size can begin so.
FileHeader parse_file_header(std::string_view beginning, std::uint64_t file_size);

/// Logical bytes of a file whose pages are checked as they are read.
class Pages {
 public:
  Pages(ReadBytes read, const FileHeader& header);

  std::uint64_t size() const { return file_size_ / page_size_ * content_; }  ///< logical

  /// Of a physical place. Throws Error{bad_file} if it is not within the file, or in a checksum;
  /// `what` is said to be there.
  std::uint64_t logical(std::uint64_t physical, const std::string& what) const;

  /// All bytes of a logical stretch, which lies within the file. Throws Error{bad_file} if a page
  /// does not agree with its checksum.
  std::string bytes(std::uint64_t place, std::uint64_t count);

 private:
  void read_window(std::uint64_t place);

  ReadBytes read_;
  std::uint64_t file_size_, page_size_, content_;
  std::string window_;  ///< contents of some pages
  std::uint64_t window_begin_ = 0;
};

/// Turns content into pages, piece by piece.
class PageWriter {
 public:
  PageWriter() = default;
  /// Goes on with a page that holds these bytes and has no checksum yet.
  explicit PageWriter(std::string open_page) : open_(std::move(open_page)) {}

  /// What a file grows by: the content, with checksums where pages end.
  std::string continued(std::string_view content);
  /// The rest of a page that was begun: zeros, and its checksum.
  std::string closed();

 private:
  std::string open_;  ///< content of the page that has no checksum yet
};

/// Pages with this content, the last one filled up with zeros.
std::string sealed(std::string_view content);

}  // namespace skycap::geometry::e57
