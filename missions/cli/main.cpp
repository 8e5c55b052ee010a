#include <atomic>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <semaphore.h>
#include <unistd.h>

#include "missions/cli/command_line.h"

namespace {

/// Signals of Ctrl-C, service managers and schedulers, and closed terminals.
constexpr int termination_signals[] = {SIGINT, SIGTERM, SIGHUP};

/// The semaphore and the number are among the few objects that a signal handler may modify.
sem_t interrupted;
std::atomic<int> termination_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void on_interrupt(int signal_number) {
  termination_signal = signal_number;
  ::sem_post(&interrupted);
  // A second signal ends the program.
  for (const int signal : termination_signals) std::signal(signal, SIG_DFL);
}

/// Ends the program when no results are unsaved. Files are committed by a single rename, and the
/// next run removes incomplete files.
[[noreturn]] void leave(bool is_terminal) {
  const std::string_view text =
      is_terminal ? "\r\033[Kskycap: interrupted\n" : "skycap: interrupted\n";
  if (::write(STDERR_FILENO, text.data(), text.size()) < 0) std::_Exit(2);
  std::_Exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  static std::stop_source stop;
  static std::atomic<int> results_held = 0;
  const bool is_terminal = ::isatty(STDERR_FILENO) == 1;
  ::sem_init(&interrupted, 0, 0);
  std::jthread watcher([is_terminal](const std::stop_token& end) {
    while (::sem_wait(&interrupted) != 0) {
    }
    if (end.stop_requested()) return;
    stop.request_stop();
    if (results_held == 0) leave(is_terminal);
  });
  for (const int signal : termination_signals) {
    // Signals ignored by the parent process, for example with nohup, remain ignored.
    if (std::signal(signal, on_interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);
  }

  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const int exit_code = skycap::missions::cli::run_command_line(
      arguments,
      {std::cout, std::cerr, is_terminal, stop.get_token(), &results_held, &termination_signal});
  watcher.request_stop();
  ::sem_post(&interrupted);  // wakes the watcher thread to end it
  return exit_code;
}
