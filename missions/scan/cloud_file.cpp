#include "missions/scan/cloud_file.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include "geometry/error.h"
#include "geometry/io/file.h"

namespace skycap::missions::scan {

void CloudTotals::add(const CloudTotals& more) {
  points += more.points;
  checksum += more.checksum;
  for (std::size_t i = 0; i < points_by_return.size(); ++i) {
    points_by_return[i] += more.points_by_return[i];
  }
  bounds.extend(more.bounds);
}

CloudFile::CloudFile(std::filesystem::path path, std::shared_ptr<const CloudFormat> format,
                     ReturnPosition position, const std::optional<CloudState>& grown)
    : path_(std::move(path)), format_(std::move(format)), position_(position) {
  if (grown) {
    go_on(*grown);
    return;
  }
  file_.reset(std::fopen(path_.c_str(), "wb"));
  if (!file_) fail();
  // Unbuffered, because chunks are large and a second copy is unnecessary.
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);
  put(format_->header(state_));
}

void CloudFile::go_on(const CloudState& grown) {
  geometry::cut_file(path_, grown.bytes);
  file_.reset(std::fopen(path_.c_str(), "r+b"));
  if (!file_ || std::fseek(file_.get(), 0, SEEK_END) != 0) fail();
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);
  state_ = grown;
  if (!format_->is_paged()) return;
  std::string open_page(grown.bytes % geometry::e57::page_size, '\0');
  const auto size = static_cast<long>(open_page.size());
  if (std::fseek(file_.get(), -size, SEEK_END) != 0 ||
      std::fread(open_page.data(), 1, open_page.size(), file_.get()) != open_page.size() ||
      std::fseek(file_.get(), 0, SEEK_END) != 0) {
    fail();
  }
  pages_ = geometry::e57::PageWriter(std::move(open_page));
}

void CloudFile::append(const CloudChunk& chunk) {
  put_content(chunk.bytes);
  state_.totals.add(chunk.totals);
}

void CloudFile::append_file(const std::filesystem::path& other, const CloudState& grown) {
  constexpr std::size_t pages = 1024, window = pages * geometry::e57::page_size;
  std::ifstream file(other, std::ios::binary);
  const std::size_t begin = format_->header({}).size();
  file.seekg(static_cast<std::streamoff>(begin));
  std::vector<std::uint8_t> bytes;
  for (std::uint64_t at = begin; at < grown.bytes; at += bytes.size()) {
    bytes.resize(std::min<std::uint64_t>(window, grown.bytes - at));
    if (!file.read(reinterpret_cast<char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()))) {
      throw Error(ErrorKind::bad_file, other.string() + ": is truncated");
    }
    if (!format_->is_paged()) {
      put_content(bytes);
      continue;
    }
    for (std::size_t page = 0; page < bytes.size(); page += geometry::e57::page_size) {
      put_content(std::span(bytes).subspan(
          page, std::min(geometry::e57::page_content, bytes.size() - page)));
    }
  }
  state_.totals.add(grown.totals);
}

void CloudFile::put_content(std::span<const std::uint8_t> bytes) {
  if (!format_->is_paged()) return put(bytes);
  put(pages_.continued({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
}

void CloudFile::sync() const { geometry::sync_to_disk(path_); }

void CloudFile::finish() {
  const std::vector<std::uint8_t> header = format_->header(state_);
  put(pages_.closed());
  std::ifstream points(path_, std::ios::binary);
  put(format_->trailer(points, state_));
  if (!header.empty()) {
    if (std::fseek(file_.get(), 0, SEEK_SET) != 0) fail();
    put(header);
    state_.bytes -= header.size();  // The final header replaces the first one.
  }
  if (std::fclose(file_.release()) != 0) fail();
}

void CloudFile::put(const std::string& bytes) {
  put(std::span(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
}

void CloudFile::put(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) fail();
  state_.bytes += bytes.size();
}

void CloudFile::fail() const {
  throw Error(ErrorKind::bad_file,
              path_.string() + ": cannot be written: " + std::generic_category().message(errno));
}

}  // namespace skycap::missions::scan
