#include "geometry/parallel.h"

#include <numeric>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::geometry {
namespace {

TEST(ParallelFor, RunsEachItemOnce) {
  for (const unsigned threads : {0U, 1U, 2U, 7U}) {
    std::vector<int> done(1000, 0);
    parallel_for(done.size(), threads, [&](std::size_t i) { ++done[i]; });
    EXPECT_THAT(done, testing::Each(1));
  }
}

TEST(ParallelFor, RethrowsExceptionOfItem) {
  const auto fail_at_37 = [](std::size_t i) {
    if (i == 37) throw std::runtime_error("item 37");
  };
  EXPECT_THROW(parallel_for(100, 3, fail_at_37), std::runtime_error);
}

}  // namespace
}  // namespace skycap::geometry
