/// Checks that a planner can be stopped while it plans a view.
#pragma once

#include <stop_token>

#include <gtest/gtest.h>

#include "survey/planner.h"

namespace skycap::tests {

/// Stops the planner while it plans a view. `scan` is its first scan and leaves frontiers.
inline void expect_stop_while_planning(survey::Planner& planner, const geometry::Scan& scan) {
  std::stop_source stop;
  planner.stop_on(stop.get_token());
  ASSERT_TRUE(planner.next_view(scan));
  stop.request_stop();
  EXPECT_THROW(planner.next_view(scan), survey::Interrupted);
  EXPECT_GT(planner.take_cloud().size(), 0U);
}

}  // namespace skycap::tests
