/// A stretch of a file, read piece by piece: no length that a file states costs memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace skycap::geometry::las {

/// Bytes from a place of the file, fewer if it ends.
using ReadBytes = std::function<std::string(std::uint64_t place, std::uint64_t count)>;

/// Throws Error{bad_file}; who knows the file's name puts it before the sentence.
[[noreturn]] void refuse(const std::string& sentence);

class ByteWindow {
 public:
  ByteWindow() = default;  ///< without bytes

  /// The bytes from `begin` to before `end`; `read` has to outlive the window.
  ByteWindow(const ReadBytes& read, std::uint64_t begin, std::uint64_t end)
      : read_(&read), unread_(begin), end_(end) {}

  /// Throws Error{bad_file} at the end.
  std::uint8_t next() {
    if (position_ == piece_.size()) read_piece();
    return static_cast<std::uint8_t>(piece_[position_++]);
  }

  /// The next bytes, all of them. Throws Error{bad_file} if there are fewer.
  void take(char* bytes, std::size_t count);

  template <typename Value>
  Value value() {
    Value value;
    take(reinterpret_cast<char*>(&value), sizeof value);
    return value;
  }

  /// Of the byte that comes next.
  std::uint64_t place() const { return unread_ - (piece_.size() - position_); }

  /// So many bytes from a place of the file. Throws Error{bad_file} if they end behind these.
  ByteWindow part(std::uint64_t begin, std::uint64_t count) const;

 private:
  void read_piece();

  const ReadBytes* read_ = nullptr;
  std::string piece_;
  std::size_t position_ = 0;
  std::uint64_t unread_ = 0, end_ = 0;
};

}  // namespace skycap::geometry::las
