/// For loops of tests over what the code under test has made: without elements nothing is tested.
#pragma once

#include <ranges>
#include <utility>

#include <gtest/gtest.h>

namespace skycap::testing_support {

/// The range itself; the test fails if it is empty.
template <std::ranges::range Range>
Range not_empty(Range&& range) {
  EXPECT_FALSE(std::ranges::empty(range)) << "the loop over it tests nothing";
  return std::forward<Range>(range);
}

}  // namespace skycap::testing_support
