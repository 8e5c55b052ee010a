#include "missions/wizard/pad_search.h"

#include <gtest/gtest.h>

#include "flight/clearance/segment_distance.h"
#include "missions/config/vehicle_reader.h"

namespace skycap::missions::wizard {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

// The place that is best without the second box is inside it.
TEST(PadSearch, KeepsClimbsClearOfOtherUnknownBoxes) {
  constexpr double top = 15.0;
  const flight::FlightOptions options{.vehicle = config::find_vehicle("generic_ardupilot"),
                                      .clearance = 2.0};
  const AlignedBox3d target(Vector3d(-10, -10, 0), Vector3d(10, 10, 12));
  const auto alone = PadSearch(options).find_pad_beside(target, top);
  ASSERT_TRUE(alone);
  const AlignedBox3d other(*alone - Vector3d(4, 4, 0), *alone + Vector3d(4, 4, 12));
  const PadSearch search(options, {other});
  EXPECT_EQ(search.climb_clearance(*alone, top, 10.0), 0.0);
  const auto pad = search.find_pad_beside(target, top);
  ASSERT_TRUE(pad);
  const flight::Segment climb{*pad, *pad + top * Vector3d::UnitZ()};
  EXPECT_GE(nearest(climb, other).squared_distance, 5.0 * 5.0);
  EXPECT_GE(nearest(climb, target).squared_distance, 5.0 * 5.0);
}

}  // namespace
}  // namespace skycap::missions::wizard
