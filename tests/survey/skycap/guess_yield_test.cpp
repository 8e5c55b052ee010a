#include <gtest/gtest.h>

#include "survey/skycap/unseen_surface.h"

namespace skycap::survey {
namespace {

TEST(GuessYield, IsWhatCameOfThePromises) {
  skycap::GuessYield yield;
  EXPECT_EQ(yield.value(), 1.0);
  yield.learn(2.0, 1.0, 0.0);
  EXPECT_DOUBLE_EQ(yield.value(), 0.5);
  yield.learn(0.0, 7.0, 7.0);  // nothing was promised: nothing is learnt
  EXPECT_DOUBLE_EQ(yield.value(), 0.5);
  yield.learn(4.0, 12.0, 12.0);  // 12.6 of 5.2
  EXPECT_DOUBLE_EQ(yield.value(), 12.6 / 5.2);
}

// Relief and noise beside what is known are worth no more than was promised.
TEST(GuessYield, IsAboveOneForNewTerritoryOnly) {
  skycap::GuessYield yield;
  yield.learn(1.0, 5.0, 0.1);
  EXPECT_DOUBLE_EQ(yield.value(), 1.0);
  yield.learn(1.0, -5.0, 0.1);  // surfels that shared their area: 1.1 - 0.4 of 1.6
  EXPECT_DOUBLE_EQ(yield.value(), 0.7 / 1.6);
}

TEST(GuessYield, NeitherEndsASurveyAtOnceNorKeepsItGoing) {
  skycap::GuessYield yield;
  yield.learn(1.0, 0.0, 0.0);
  EXPECT_DOUBLE_EQ(yield.value(), 0.15);
  yield.learn(1.0, 1000.0, 1000.0);
  EXPECT_DOUBLE_EQ(yield.value(), 6.0);
  // Ten scans in vain, and the great find is forgotten.
  for (int scan = 0; scan < 10; ++scan) yield.learn(1.0, 0.0, 0.0);
  EXPECT_DOUBLE_EQ(yield.value(), 0.15);
}

}  // namespace
}  // namespace skycap::survey
