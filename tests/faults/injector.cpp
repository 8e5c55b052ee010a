// Preloaded library that counts the steps of a program and makes one of them fail, or kills the
// program at that step.
//
// FAULT_KIND   counted steps and their effect:
//   "full"    disk operations fail with ENOSPC, except removals, which a full disk allows
//   "kill"    disk operations; the process is killed as by kill -9
//   "memory"  allocations fail
//   "start"   starts of other programs fail with EAGAIN
//   "unflushed"  renames of files, and further appended records, before earlier data of the file
//   has
//             been flushed; no effect. After a power failure, this data may be missing.
// FAULT_AT     number of the step, counted from 1; 0: none
// FAULT_COUNT  file that receives the number of steps when the program ends
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <set>
#include <utility>

#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

extern "C" void* __libc_malloc(size_t size) noexcept;  // dlsym() allocates memory

namespace {

enum class Kind { none, full, kill, memory, start, unflushed };

Kind parse_fault_kind(const char* name) {
  if (name == nullptr) return Kind::none;
  if (std::strcmp(name, "full") == 0) return Kind::full;
  if (std::strcmp(name, "kill") == 0) return Kind::kill;
  if (std::strcmp(name, "memory") == 0) return Kind::memory;
  if (std::strcmp(name, "start") == 0) return Kind::start;
  if (std::strcmp(name, "unflushed") == 0) return Kind::unflushed;
  return Kind::none;
}

/// Set when this library is loaded. Earlier steps are not counted.
Kind kind = Kind::none;
long fault_step = 0;
std::atomic<long> steps{0};

/// Counts a step. Returns true if this step is the fault point.
bool is_hit() { return ++steps == fault_step; }

/// Counts a disk operation. Returns true if it must fail.
bool fails(bool needs_space = true) {
  if (kind != Kind::full && kind != Kind::kill) return false;
  if (!is_hit()) return false;
  if (kind == Kind::kill) ::raise(SIGKILL);
  errno = ENOSPC;
  return needs_space;
}

/// Device and inode of the files whose data has been written but not flushed.
class UnflushedFiles {
 public:
  void note_write(int handle) { change(handle, true); }
  void note_flush(int handle) { change(handle, false); }
  void note_rename(const char* from) {
    struct stat status {};
    if (kind != Kind::unflushed || ::lstat(from, &status) != 0) return;
    const std::lock_guard lock(mutex_);
    if (files_.contains({status.st_dev, status.st_ino})) ++steps;
  }

 private:
  void change(int handle, bool is_written) {
    struct stat status {};
    if (kind != Kind::unflushed || ::fstat(handle, &status) != 0) return;
    if (!S_ISREG(status.st_mode)) return;
    const std::lock_guard lock(mutex_);
    const std::pair file(status.st_dev, status.st_ino);
    if (!is_written) {
      files_.erase(file);
    } else if (!files_.insert(file).second && (::fcntl(handle, F_GETFL) & O_APPEND) != 0) {
      ++steps;
    }
  }

  std::mutex mutex_;
  std::set<std::pair<dev_t, ino_t>> files_;
} unflushed;

template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// Returns true for files, false for the standard streams.
bool is_file(int handle) { return handle > STDERR_FILENO; }

class Switch {
 public:
  Switch() {
    const char* at = std::getenv("FAULT_AT");
    const char* count = std::getenv("FAULT_COUNT");
    if (count != nullptr) std::snprintf(count_, sizeof(count_), "%s", count);
    ::unsetenv("FAULT_COUNT");  // child processes must not overwrite the count
    fault_step = at == nullptr ? 0 : std::atol(at);
    kind = parse_fault_kind(std::getenv("FAULT_KIND"));
  }
  ~Switch() {
    kind = Kind::none;
    if (count_[0] == '\0') return;
    const int handle = ::open(count_, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dprintf(handle, "%ld\n", steps.load());
    ::close(handle);
  }

 private:
  char count_[4096] = "";
} on_while_loaded;

}  // namespace

extern "C" {

ssize_t write(int handle, const void* bytes, size_t count) {
  unflushed.note_write(handle);
  if (is_file(handle) && fails()) return -1;
  return real<ssize_t(int, const void*, size_t)>("write")(handle, bytes, count);
}

ssize_t writev(int handle, const iovec* parts, int count) {
  unflushed.note_write(handle);
  if (is_file(handle) && fails()) return -1;
  return real<ssize_t(int, const iovec*, int)>("writev")(handle, parts, count);
}

ssize_t pwrite(int handle, const void* bytes, size_t count, off_t at) {
  unflushed.note_write(handle);
  if (is_file(handle) && fails()) return -1;
  return real<ssize_t(int, const void*, size_t, off_t)>("pwrite")(handle, bytes, count, at);
}

size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  unflushed.note_write(::fileno(file));
  if (is_file(::fileno(file)) && fails()) return 0;
  return real<size_t(const void*, size_t, size_t, FILE*)>("fwrite")(bytes, size, count, file);
}

int fsync(int handle) {
  unflushed.note_flush(handle);
  return fails() ? -1 : real<int(int)>("fsync")(handle);
}

int ftruncate(int handle, off_t size) noexcept {
  return fails() ? -1 : real<int(int, off_t)>("ftruncate")(handle, size);
}

int rename(const char* from, const char* to) noexcept {
  unflushed.note_rename(from);
  return fails() ? -1 : real<int(const char*, const char*)>("rename")(from, to);
}

int mkdir(const char* path, mode_t mode) noexcept {
  return fails() ? -1 : real<int(const char*, mode_t)>("mkdir")(path, mode);
}

int unlink(const char* path) noexcept {
  fails(false);
  return real<int(const char*)>("unlink")(path);
}

int remove(const char* path) noexcept {
  fails(false);
  return real<int(const char*)>("remove")(path);
}

int open(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(list, mode_t) : 0;
  va_end(list);
  if ((flags & O_CREAT) != 0 && fails()) return -1;
  return real<int(const char*, int, ...)>("open")(path, flags, mode);
}

FILE* fopen(const char* path, const char* mode) {
  if (*mode == 'w' && fails()) return nullptr;
  return real<FILE*(const char*, const char*)>("fopen")(path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
  if (*mode == 'w' && fails()) return nullptr;
  return real<FILE*(const char*, const char*)>("fopen64")(path, mode);
}

void* malloc(size_t size) noexcept {
  if (kind == Kind::memory && is_hit()) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_malloc(size);
}

int posix_spawnp(pid_t* process, const char* file, const posix_spawn_file_actions_t* actions,
                 const posix_spawnattr_t* attributes, char* const* arguments,
                 char* const* environment) {
  if (kind == Kind::start && is_hit()) return EAGAIN;
  using Spawn = int(pid_t*, const char*, const posix_spawn_file_actions_t*,
                    const posix_spawnattr_t*, char* const*, char* const*);
  return real<Spawn>("posix_spawnp")(process, file, actions, attributes, arguments, environment);
}
}
