#include "missions/support/child_process.h"

#include <csignal>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include "tests/support/complaint.h"

namespace skycap::missions::support {
namespace {

std::string error_message(const std::function<void(PipeWriter&)>& work) {
  return testing_support::thrown_message([&] {
    ChildProcess({"x.file", "their library", 1}, work).read<int>();
  });
}

TEST(ChildProcess, ReturnsResults) {
  ChildProcess child({"x.file", "their library", 1}, [](PipeWriter& pipe) {
    pipe.put(7);
    pipe.put_text("words");
    const std::vector<double> numbers(100'000, 0.5);
    pipe.put_row(numbers.data(), numbers.size());
  });
  EXPECT_EQ(child.read<int>(), 7);
  EXPECT_EQ(child.read_text(), "words");
  EXPECT_EQ(child.read_row<std::vector<double>>(), std::vector<double>(100'000, 0.5));
}

TEST(ChildProcess, ReportsCrashOrEarlyExit) {
  const std::string end = "x.file: is damaged: their library stopped while reading it";
  EXPECT_EQ(error_message([](PipeWriter&) { std::raise(SIGKILL); }), end);
  EXPECT_EQ(error_message([](PipeWriter&) {}), end);
}

TEST(ChildProcess, HasNoMoreThanItsMemory) {
  const auto can_reserve = [](std::size_t bytes) {
    ChildProcess child({"x.file", "their library", 1}, [bytes](PipeWriter& pipe) {
      void* const memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                                  MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
      pipe.put(memory != MAP_FAILED);
    });
    return child.read<bool>();
  };
  EXPECT_TRUE(can_reserve(max_child_memory / 2));
  EXPECT_FALSE(can_reserve(max_child_memory + 1));
}

TEST(ChildProcess, EndsAfterTimeout) {
  const auto loop = [](PipeWriter&) {
    for (volatile bool goes_on = true; goes_on;) {
    }
  };
  EXPECT_EQ(error_message(loop),
            "x.file: timeout: their library took more than 1 s, which is too long for an intact "
            "file of this size");
  const ChildProcess left({"x.file", "their library"}, loop);  // ended by its destructor
}

}  // namespace
}  // namespace skycap::missions::support
