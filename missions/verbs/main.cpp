#include <csignal>
#include <iostream>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <semaphore.h>
#include <unistd.h>

#include "missions/verbs/command_line.h"

namespace {

/// A signal handler may do next to nothing, but it may post a semaphore.
sem_t interrupted;

extern "C" void on_interrupt(int) {
  ::sem_post(&interrupted);
  std::signal(SIGINT, SIG_DFL);  // the second Ctrl-C ends the program at once
}

}  // namespace

int main(int argc, char** argv) {
  static std::stop_source stop;
  ::sem_init(&interrupted, 0, 0);
  std::jthread watcher([](const std::stop_token& end) {
    while (::sem_wait(&interrupted) != 0) {
    }
    if (!end.stop_requested()) stop.request_stop();
  });
  std::signal(SIGINT, on_interrupt);

  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool is_terminal = ::isatty(STDERR_FILENO) == 1;
  const int exit_code = skycap::missions::verbs::run_command_line(
      arguments, {std::cout, std::cerr, is_terminal, stop.get_token()});
  watcher.request_stop();
  ::sem_post(&interrupted);  // wakes the watcher, to end it
  return exit_code;
}
