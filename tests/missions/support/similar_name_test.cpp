#include "missions/support/similar_name.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace skycap::missions::support {
namespace {

TEST(EditDistance, CountsInsertionsDeletionsReplacementsAndSwaps) {
  EXPECT_EQ(edit_distance("plan", "plan"), 0U);
  EXPECT_EQ(edit_distance("", "plan"), 4U);
  EXPECT_EQ(edit_distance("plan", ""), 4U);
  EXPECT_EQ(edit_distance("pla", "plan"), 1U);
  EXPECT_EQ(edit_distance("plann", "plan"), 1U);
  EXPECT_EQ(edit_distance("plen", "plan"), 1U);
  EXPECT_EQ(edit_distance("paln", "plan"), 1U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("ca", "abc"), 3U);  // a swapped pair is not edited again
}

TEST(SimilarName, AcceptsSlightMisspellings) {
  const std::vector<std::string> names{"plan", "scan", "check", "evaluate", "benchmark"};
  EXPECT_EQ(find_similar("paln", names), "plan");
  EXPECT_EQ(find_similar("chekc", names), "check");
  EXPECT_EQ(find_similar("evalute", names), "evaluate");
  EXPECT_EQ(find_similar("bnechmarks", names), "benchmark");
  EXPECT_EQ(find_similar("soar", names), "");
  EXPECT_EQ(find_similar("", names), "");
  EXPECT_EQ(find_similar("plan" + std::string(1000, 'n'), names), "");
}

}  // namespace
}  // namespace skycap::missions::support
