#include "geometry/io/e57/pages.h"

#include <algorithm>
#include <bit>

#include "geometry/byte_values.h"
#include "geometry/error.h"
#include "geometry/io/e57/crc32c.h"
#include "geometry/io/e57/layout.h"

namespace skycap::geometry::e57 {
namespace {

std::uint32_t stored_checksum(std::string_view page) {
  std::uint32_t sum = 0;
  for (const char byte : page.substr(page.size() - checksum_size)) {
    sum = sum << 8 | static_cast<std::uint8_t>(byte);
  }
  return sum;
}

}  // namespace

void throw_bad_file(const std::string& sentence) { throw Error(ErrorKind::bad_file, sentence); }

FileHeader parse_file_header(std::string_view beginning, std::uint64_t file_size) {
  if (!beginning.starts_with("ASTM-E57") || beginning.size() < header::size) {
    throw_bad_file("is not an E57 file: it does not begin with an E57 header");
  }
  const auto major = value_at<std::uint32_t>(beginning.data(), header::major);
  if (major != 1) throw_bad_file("is E57 of version " + std::to_string(major) + "; it must be 1");
  const auto field = [&](std::size_t offset) {
    return value_at<std::uint64_t>(beginning.data(), offset);
  };
  const FileHeader found{field(header::file_size), field(header::description),
                         field(header::description_size), field(header::page_size)};
  constexpr std::uint64_t min_page = 128, largest_page = 1 << 20;
  if (!std::has_single_bit(found.page_size) || found.page_size < min_page ||
      found.page_size > largest_page) {
    throw_bad_file("has pages of " + std::to_string(found.page_size) +
                   " bytes; the page size must be a power of two from 128 to 1048576");
  }
  if (found.file_size > file_size) {
    throw_bad_file("ends after " + std::to_string(file_size) + " of its " +
                   std::to_string(found.file_size) + " bytes");
  }
  if (found.file_size == 0 || found.file_size % found.page_size != 0) {
    throw_bad_file("declares " + std::to_string(found.file_size) +
                   " bytes; its size must be a multiple of the page size, " +
                   std::to_string(found.page_size));
  }
  return found;
}

Pages::Pages(ReadBytes read, const FileHeader& header)
    : read_(std::move(read)),
      file_size_(header.file_size),
      page_size_(header.page_size),
      content_(header.page_size - checksum_size) {}

std::uint64_t Pages::logical(std::uint64_t physical, const std::string& what) const {
  const std::uint64_t page = physical / page_size_, in_page = physical % page_size_;
  if (physical >= file_size_ || in_page >= content_) {
    throw_bad_file("declares that " + what + " is at byte " + std::to_string(physical) +
                   ", which is " + (physical >= file_size_ ? "after its end" : "in a checksum"));
  }
  return page * content_ + in_page;
}

std::string Pages::bytes(std::uint64_t offset, std::uint64_t count) {
  std::string result;
  result.reserve(count);
  while (result.size() < count) {
    const std::uint64_t next = offset + result.size();
    if (next < window_begin_ || next >= window_begin_ + window_.size()) read_window(next);
    result.append(window_, next - window_begin_, count - result.size());
  }
  return result;
}

void Pages::read_window(std::uint64_t offset) {
  constexpr std::uint64_t usual_window = 1 << 16;
  const std::uint64_t first = offset / content_ * page_size_;
  const std::uint64_t size =
      std::min(std::max(usual_window, page_size_), file_size_ - std::min(first, file_size_));
  window_.clear();
  window_begin_ = offset / content_ * content_;
  const std::string read = read_(first, size);
  const std::string_view pages = read;
  if (pages.empty() || pages.size() < size) {
    throw_bad_file("cannot be read at byte " + std::to_string(first));
  }
  for (std::uint64_t begin = 0; begin < size; begin += page_size_) {
    const std::string_view page = pages.substr(begin, page_size_);
    if (crc32c(page.substr(0, content_)) != stored_checksum(page)) {
      window_.clear();
      throw_bad_file("is damaged: the page at byte " + std::to_string(first + begin) +
                     " has a wrong checksum");
    }
    window_ += page.substr(0, content_);
  }
}

std::string PageWriter::continued(std::string_view content) {
  std::string bytes;
  bytes.reserve(content.size() + (content.size() / page_content + 1) * checksum_size);
  while (!content.empty()) {
    const std::string_view part = content.substr(0, page_content - open_.size());
    content.remove_prefix(part.size());
    open_ += part;
    bytes += part;
    if (open_.size() < page_content) break;
    const std::uint32_t sum = crc32c(open_);
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(sum >> shift & 0xFF);
    open_.clear();
  }
  return bytes;
}

std::string PageWriter::closed() {
  return open_.empty() ? std::string() : continued(std::string(page_content - open_.size(), '\0'));
}

std::string sealed(std::string_view content) {
  PageWriter writer;
  std::string pages = writer.continued(content);
  return pages + writer.closed();
}

}  // namespace skycap::geometry::e57
