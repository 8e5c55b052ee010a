/// For test loops over results of the code under test: a loop over no elements would test nothing.
#pragma once

#include <ranges>
#include <utility>

#include <gtest/gtest.h>

namespace skycap::testing_support {

/// Returns the range. The test fails if the range is empty.
template <std::ranges::range Range>
Range not_empty(Range&& range) {
  EXPECT_FALSE(std::ranges::empty(range)) << "the loop over it tests nothing";
  return std::forward<Range>(range);
}

}  // namespace skycap::testing_support
