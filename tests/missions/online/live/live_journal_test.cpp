#include "missions/online/live/live_journal.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/complaint.h"

namespace skycap::missions::online {
namespace {

using testing::HasSubstr;
using testing_support::thrown_message;

ScanRecord scan_in(const std::string& file) {
  return {.id = "1", .file = file, .sha256 = std::string(64, '0'), .pose = {}};
}

std::string rejection(const ScanRecord& scan) {
  return thrown_message([&] { parse_events({"identity", to_journal_line(scan)}, "live.journal"); });
}

TEST(LiveJournal, RejectsScanFilesOutsideTheSurveyFolder) {
  EXPECT_EQ(parse_events({"identity", to_journal_line(scan_in("scans/1.ply"))}, "j").size(), 1U);
  for (const char* file : {"/etc/passwd", "../1.ply", "scans/../../1.ply"}) {
    EXPECT_THAT(rejection(scan_in(file)), HasSubstr("outside the survey folder")) << file;
  }
}

TEST(LiveJournal, RejectsScaledAndMirroredPoses) {
  for (const double x : {-1.0, 1.1}) {
    ScanRecord scan = scan_in("scans/1.ply");
    scan.world_from_sensor.linear()(0, 0) = x;
    EXPECT_THAT(rejection(scan), HasSubstr("rotation without scale or reflection")) << x;
  }
}

}  // namespace
}  // namespace skycap::missions::online
