// Start and termination of external programs.
#include "missions/support/external_program.h"

#include <chrono>
#include <stop_token>
#include <thread>

#include <gtest/gtest.h>

namespace skycap::missions::support {
namespace {

using namespace std::chrono_literals;

TEST(ExternalProgram, ReturnsExitCodeAndOutput) {
  const ProgramResult result = run_external_program({"sh", "-c", "pwd; echo no >&2; exit 7"}, "/");
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_EQ(result.output, "/\nno\n");
  EXPECT_EQ(run_external_program({"no-such-program"}, "/").exit_code, 127);
}

// GNU parallel treats the first signal as a request to start no new jobs.
TEST(ExternalProgram, IsStoppedEvenWhenFirstSignalIsIgnored) {
  for (const char* script :
       {"exec sleep 60", "trap 'trap - TERM' TERM; while :; do sleep 0.05; done",
        "while :; do echo much; sleep 0.01; done"}) {
    std::stop_source stop;
    std::jthread stopper([&] {
      std::this_thread::sleep_for(200ms);
      stop.request_stop();
    });
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(run_external_program({"sh", "-c", script}, "/", stop.get_token()).exit_code, 143);
    EXPECT_LT(std::chrono::steady_clock::now() - start, 2s) << script;
  }
}

}  // namespace
}  // namespace skycap::missions::support
