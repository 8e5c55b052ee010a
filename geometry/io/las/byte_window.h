/// Range of a file that is read in pieces, so that invalid lengths in a file cannot exhaust the
/// memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace skycap::geometry::las {

/// Returns `count` bytes from offset `offset`, or fewer at the end of the file.
using ReadBytes = std::function<std::string(std::uint64_t offset, std::uint64_t count)>;

/// Throws Error{bad_file}. Callers that know the file name prepend it to the message.
[[noreturn]] void throw_bad_file(const std::string& sentence);

class ByteWindow {
 public:
  ByteWindow() = default;  ///< Creates an empty window.

  /// Range [begin, end) of the file. `read` must outlive the window.
  ByteWindow(const ReadBytes& read, std::uint64_t begin, std::uint64_t end)
      : read_(&read), unread_(begin), end_(end) {}

  /// Reads the next byte. Throws Error{bad_file} at the end.
  std::uint8_t next() {
    if (position_ == chunk_.size()) read_chunk();
    return static_cast<std::uint8_t>(chunk_[position_++]);
  }

  /// Reads exactly `count` bytes. Throws Error{bad_file} if there are fewer.
  void take(char* bytes, std::size_t count);

  template <typename Value>
  Value value() {
    Value value;
    take(reinterpret_cast<char*>(&value), sizeof value);
    return value;
  }

  /// Returns the file offset of the next byte.
  std::uint64_t offset() const { return unread_ - (chunk_.size() - position_); }

  /// Returns a window of `count` bytes at file offset `begin`. Throws Error{bad_file} if it exceeds
  /// the end of this window.
  ByteWindow part(std::uint64_t begin, std::uint64_t count) const;

 private:
  void read_chunk();

  const ReadBytes* read_ = nullptr;
  std::string chunk_;
  std::size_t position_ = 0;
  std::uint64_t unread_ = 0, end_ = 0;
};

}  // namespace skycap::geometry::las
