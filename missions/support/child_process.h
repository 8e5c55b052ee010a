/// Runs third-party parsers in a child process. A malicious file may crash them, or make them loop
/// or exhaust memory; such failures are reported as errors and do not affect the program.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <sys/types.h>

namespace skycap::missions::support {

/// Memory limit of the child, in addition to the memory of this process [byte].
inline constexpr std::size_t max_child_memory = std::size_t{2} << 30;

/// Write end of the pipe in the child. Values are written in the machine's native representation.
/// The child exits when the read end is closed.
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

/// Child process with the read end of its pipe.
class ChildProcess {
 public:
  struct ReadContext {
    std::string file;     ///< file name at the start of messages
    std::string library;  ///< name of the parsing library in messages
    unsigned seconds = std::numeric_limits<unsigned>::max();  ///< limit of the processor time [s]
  };

  /// Runs `work` in a child process. It must not throw, and writes its results to the pipe. Its
  /// standard output is discarded. Throws Error{bad_file} if no pipe or process can be created.
  ChildProcess(ReadContext context, const std::function<void(PipeWriter&)>& work);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();

  // Returns the next value written by the child. Throws Error{bad_file} if the child has ended
  // before writing it.
  template <typename Value>
  Value read() {
    Value value;
    read_bytes(&value, sizeof value);
    return value;
  }
  template <typename Values>
  Values read_row() {
    Values values(read_count(sizeof(typename Values::value_type)), typename Values::value_type{});
    read_bytes(values.data(), values.size() * sizeof(typename Values::value_type));
    return values;
  }
  std::string read_text() { return read_row<std::string>(); }

 private:
  void read_bytes(void* data, std::size_t size);
  std::size_t read_count(std::size_t item_size);
  /// Waits for the child and returns its status.
  int wait();
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_by_end();

  ReadContext context_;
  int file_ = -1;
  pid_t child_ = -1;
};

}  // namespace skycap::missions::support
