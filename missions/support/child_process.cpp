#include "missions/support/child_process.h"

#include <cerrno>
#include <csignal>
#include <fstream>
#include <utility>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geometry/error.h"

namespace skycap::missions::support {
namespace {

template <typename Resource>
void lower_limit(Resource resource, rlim_t max) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) return;
  if (limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur <= max) return;
  limit.rlim_cur = max;
  ::setrlimit(resource, &limit);
}

void bound(unsigned seconds) {
  lower_limit(RLIMIT_CORE, 0);
  if (seconds != std::numeric_limits<unsigned>::max()) lower_limit(RLIMIT_CPU, seconds);
  std::size_t pages = 0;
  if (!(std::ifstream("/proc/self/statm") >> pages)) return;
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  lower_limit(RLIMIT_AS, pages * page + max_child_memory);
}

/// Resets the signal handlers inherited from the program, so that Ctrl-C ends the child. The child
/// also ends when its parent does.
void follow(pid_t parent) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
}

[[noreturn]] void be_child(int file, pid_t parent, unsigned seconds,
                           const std::function<void(PipeWriter&)>& work) {
  follow(parent);
  // Discards output written by the library.
  if (const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC); nothing >= 0) {
    ::dup2(nothing, STDOUT_FILENO);
    ::dup2(nothing, STDERR_FILENO);
  }
  bound(seconds);
  PipeWriter pipe(file);
  work(pipe);
  ::_exit(0);
}

}  // namespace

void PipeWriter::put_bytes(const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t count = ::write(file_, at, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) ::_exit(1);
    at += count;
    size -= static_cast<std::size_t>(count);
  }
}

ChildProcess::ChildProcess(ReadContext context, const std::function<void(PipeWriter&)>& work)
    : context_(std::move(context)) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail("cannot create a pipe");
  const pid_t parent = ::getpid();
  child_ = ::fork();
  if (child_ == 0) {
    ::close(ends[0]);
    be_child(ends[1], parent, context_.seconds, work);
  }
  ::close(ends[1]);
  file_ = ends[0];
  if (child_ < 0) {
    ::close(file_);
    fail("cannot start a process");
  }
}

ChildProcess::~ChildProcess() {
  ::close(file_);
  if (child_ > 0) ::kill(child_, SIGKILL);  // the child has no results to save
  wait();
}

int ChildProcess::wait() {
  int status = 0;
  if (child_ < 0) return status;
  while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  return status;
}

void ChildProcess::read_bytes(void* data, std::size_t size) {
  char* at = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t count = ::read(file_, at, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail_by_end();
    at += count;
    size -= static_cast<std::size_t>(count);
  }
}

std::size_t ChildProcess::read_count(std::size_t item_size) {
  const auto count = read<std::size_t>();
  if (count > max_child_memory / item_size) fail("is damaged");
  return count;
}

void ChildProcess::fail(const std::string& what) const {
  throw Error(ErrorKind::bad_file, context_.file + ": " + what);
}

void ChildProcess::fail_by_end() {
  const int status = wait();
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    fail("timeout: " + context_.library + " took more than " + std::to_string(context_.seconds) +
         " s, which is too long for an intact file of this size");
  }
  fail("is damaged: " + context_.library + " stopped while reading it");
}

}  // namespace skycap::missions::support
