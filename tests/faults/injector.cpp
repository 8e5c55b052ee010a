// A library to be preloaded into a program: it counts what the program does to the disk, and has
// one of these steps fail, or the program die there.
//
//   FAULT_AT     number of the step, counted from one; 0: none
//   FAULT_KIND   "full": ENOSPC; "kill": the process dies, as by kill -9
//   FAULT_COUNT  a file that the number of steps is written to when the program ends
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

std::atomic<long> steps{0};

long wanted() {
  static const long at = std::getenv("FAULT_AT") ? std::atol(std::getenv("FAULT_AT")) : 0;
  return at;
}

/// Counts a step; true if it is to fail.
bool fails() {
  if (++steps != wanted()) return false;
  const char* kind = std::getenv("FAULT_KIND");
  if (kind != nullptr && std::strcmp(kind, "kill") == 0) ::raise(SIGKILL);
  errno = ENOSPC;
  return true;
}

template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// Files alone: not the streams to the terminal.
bool is_file(int handle) { return handle > STDERR_FILENO; }

struct Reporter {
  ~Reporter() {
    const char* name = std::getenv("FAULT_COUNT");
    if (name == nullptr) return;
    const int handle = real<int(const char*, int, ...)>("open")(name, O_WRONLY | O_CREAT, 0600);
    ::dprintf(handle, "%ld\n", steps.load());
    ::close(handle);
  }
} reporter;

}  // namespace

extern "C" {

ssize_t write(int handle, const void* bytes, size_t count) {
  if (is_file(handle) && fails()) return -1;
  return real<ssize_t(int, const void*, size_t)>("write")(handle, bytes, count);
}

ssize_t writev(int handle, const iovec* parts, int count) {
  if (is_file(handle) && fails()) return -1;
  return real<ssize_t(int, const iovec*, int)>("writev")(handle, parts, count);
}

size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  if (is_file(::fileno(file)) && fails()) return 0;
  return real<size_t(const void*, size_t, size_t, FILE*)>("fwrite")(bytes, size, count, file);
}

int fsync(int handle) { return fails() ? -1 : real<int(int)>("fsync")(handle); }

int ftruncate(int handle, off_t size) noexcept {
  return fails() ? -1 : real<int(int, off_t)>("ftruncate")(handle, size);
}

int rename(const char* from, const char* to) noexcept {
  return fails() ? -1 : real<int(const char*, const char*)>("rename")(from, to);
}

int mkdir(const char* path, mode_t mode) noexcept {
  return fails() ? -1 : real<int(const char*, mode_t)>("mkdir")(path, mode);
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
}
