/// Libraries of others that a hostile file makes crash, loop or run out of memory, in a process of
/// their own: there that ends the reader, in a message, and not the program.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <sys/types.h>

namespace skycap::missions::support {

/// Of the child, on top of what this process has.
inline constexpr std::size_t most_child_memory = std::size_t{2} << 30;

/// The child's end of the pipe. Numbers are as this machine has them. The child ends when nobody
/// listens any more.
class PipeWriter {
 public:
  explicit PipeWriter(int file) : file_(file) {}

  template <typename Value>
  void put(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    put_bytes(&value, sizeof value);
  }
  template <typename Value>
  void put_row(const Value* values, std::size_t count) {
    put(count);
    put_bytes(values, count * sizeof(Value));
  }
  void put_text(const std::string& text) { put_row(text.data(), text.size()); }

 private:
  void put_bytes(const void* data, std::size_t size);

  int file_;
};

/// A child, and this process's end of the pipe.
class ChildProcess {
 public:
  struct Reading {
    std::string file;                                         ///< opens messages
    std::string library;                                      ///< that reads it, for messages
    unsigned seconds = std::numeric_limits<unsigned>::max();  ///< of processor time, at most
  };

  /// Has a child do `work`, which must not throw and writes what it finds. What it prints is
  /// dropped. Throws Error{bad_file} if there are no pipes or processes left.
  ChildProcess(Reading reading, const std::function<void(PipeWriter&)>& work);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();

  // What the child has written, in its order. Throws Error{bad_file} if the child has ended before.
  template <typename Value>
  Value take() {
    Value value;
    take_bytes(&value, sizeof value);
    return value;
  }
  template <typename Values>
  Values take_row() {
    Values values(take_count(sizeof(typename Values::value_type)), typename Values::value_type{});
    take_bytes(values.data(), values.size() * sizeof(typename Values::value_type));
    return values;
  }
  std::string take_text() { return take_row<std::string>(); }

 private:
  void take_bytes(void* data, std::size_t size);
  std::size_t take_count(std::size_t item_size);
  /// Waits for the child, and says how it ended.
  int wait();
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_by_end();

  Reading reading_;
  int file_ = -1;
  pid_t child_ = -1;
};

}  // namespace skycap::missions::support
