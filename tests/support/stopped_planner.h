/// That a planner can be stopped in the middle of a view.
#pragma once

#include <stop_token>

#include <gtest/gtest.h>

#include "survey/planner.h"

namespace skycap::tests {

/// `scan` is the planner's first, and leaves something to look at.
inline void expect_stop_while_planning(survey::Planner& planner, const geometry::Scan& scan) {
  std::stop_source stop;
  planner.stop_on(stop.get_token());
  ASSERT_TRUE(planner.next_view(scan));
  stop.request_stop();
  EXPECT_THROW(planner.next_view(scan), survey::Interrupted);
  EXPECT_GT(planner.take_cloud().size(), 0U);
}

}  // namespace skycap::tests
