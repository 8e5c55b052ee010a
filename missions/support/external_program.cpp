#include "missions/support/external_program.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace skycap::missions::support {
namespace {

void check(int error, const char* what) {
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

/// Returns the arguments for posix_spawn. They are valid as long as `command`.
std::vector<char*> make_argv(const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  return arguments;
}

/// Reads a program's output until it ends or the pipe is closed.
std::string read_output(pid_t process, int pipe, const std::stop_token& stop) {
  // SIGTERM is repeated, because programs such as GNU parallel end only after the second signal.
  constexpr std::chrono::milliseconds interval(300);
  auto next_signal = std::chrono::steady_clock::now();
  std::string output;
  std::array<char, 4096> buffer{};
  for (;;) {
    if (stop.stop_requested() && std::chrono::steady_clock::now() >= next_signal) {
      ::kill(process, SIGTERM);
      next_signal = std::chrono::steady_clock::now() + interval;
    }
    pollfd wait{pipe, POLLIN, 0};
    if (stop.stop_possible() && ::poll(&wait, 1, 100) <= 0) continue;
    const ssize_t count = ::read(pipe, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return output;
    output.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

ProgramResult run_external_program(const std::vector<std::string>& command,
                                   const std::filesystem::path& folder,
                                   const std::stop_token& stop) {
  std::array<int, 2> ends{};  // read end and write end of the pipe
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) check(errno, "pipe");

  std::vector<char*> arguments = make_argv(command);
  posix_spawn_file_actions_t actions;
  check(::posix_spawn_file_actions_init(&actions), "posix_spawn_file_actions_init");
  ::posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  pid_t process = 0;
  const int error =
      ::posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    if (error == ENOENT) return {127, ""};
    return {126, command[0] + " cannot be started: " + std::generic_category().message(error)};
  }

  ProgramResult result;
  result.output = read_output(process, ends[0], stop);
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

bool start_external_program(const std::vector<std::string>& command) {
  std::vector<char*> arguments = make_argv(command);
  posix_spawn_file_actions_t actions;
  check(::posix_spawn_file_actions_init(&actions), "posix_spawn_file_actions_init");
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
    ::posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  }
  posix_spawnattr_t attributes;
  check(::posix_spawnattr_init(&attributes), "posix_spawnattr_init");
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  pid_t process = 0;
  const int error =
      ::posix_spawnp(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) return false;
  check(error, command[0].c_str());
  return true;
}

}  // namespace skycap::missions::support
