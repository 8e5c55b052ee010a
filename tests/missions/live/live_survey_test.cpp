#include "missions/live/live_survey.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/record_log.h"
#include "tests/missions/flown_mission.h"
#include "tests/missions/live/rehearsal.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"

namespace skycap::missions::live {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::complaint_of;
using tests::content_of;

TEST(LiveSurvey, FedByTheSimulatorIsWhatPlanDoes) {
  for (const std::string& mission :
       {short_mission(tests::quick_mission(), "see++"), short_mission(tests::quick_mission(), "oa"),
        short_mission(tests::flown_mission())}) {
    const tests::TestFolder folder;
    const Rehearsal rehearsal(mission);
    LiveSurvey survey = rehearsal.open(folder.path());
    while (survey.proposal().view) rehearsal.add_one(survey);
    expect_same(survey.finish(), rehearsal.planned());
  }
}

TEST(LiveSurvey, GoesOnWhereItWasAfterEveryScan) {
  for (const std::string& mission :
       {short_mission(tests::quick_mission(), "see++"), short_mission(tests::flown_mission())}) {
    const tests::TestFolder folder;
    const Rehearsal rehearsal(mission);
    while (rehearsal.open(folder.path()).proposal().view) {
      LiveSurvey survey = rehearsal.open(folder.path());
      rehearsal.add_one(survey);
    }
    expect_same(rehearsal.open(folder.path()).finish(), rehearsal.planned());
  }
}

/// A kill leaves any beginning of the journal, and maybe a scan that it does not know yet.
TEST(LiveSurvey, GoesOnFromAnyBeginningOfItsJournal) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(short_mission(tests::quick_mission(), "see++"));
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    for (int i = 0; i < 5; ++i) rehearsal.add_one(survey);
  }
  const fs::path journal = folder.path() / "live.journal";
  const std::string whole = content_of(journal);
  const run::SurveyRecord planned = rehearsal.planned();
  constexpr std::size_t parts = 9;
  for (std::size_t part = 0; part <= parts; ++part) {
    std::ofstream(journal, std::ios::binary) << whole.substr(0, part * whole.size() / parts);
    LiveSurvey survey = rehearsal.open(folder.path());
    while (survey.proposal().view) rehearsal.add_one(survey);
    expect_same(survey.finish(), planned);
  }
}

TEST(LiveSurvey, IgnoresAScanThatItKnows) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission());
  LiveSurvey survey = rehearsal.open(folder.path());
  const geometry::Scan scan = rehearsal.scan(survey);
  EXPECT_TRUE(survey.add(scan, "a"));
  const Proposal before = survey.proposal();
  EXPECT_FALSE(survey.add(scan, "a"));
  EXPECT_EQ(survey.number_of("a"), 0);
  EXPECT_EQ(survey.number_of("b"), std::nullopt);
  EXPECT_EQ(survey.views().size(), 1U);
  EXPECT_EQ(survey.proposal().view->position, before.view->position);
}

TEST(LiveSurvey, RemembersRefusals) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission());
  Eigen::Vector3d first, second;
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    EXPECT_THROW(survey.refuse("too early"), Error);
    rehearsal.add_one(survey);
    first = survey.proposal().view->position;
    survey.refuse("behind the fence");
    ASSERT_TRUE(survey.proposal().view);
    second = survey.proposal().view->position;
    EXPECT_NE(first, second);
  }
  const LiveSurvey survey = rehearsal.open(folder.path());
  EXPECT_EQ(survey.proposal().view->position, second);
  EXPECT_EQ(survey.proposal().number, 2U);
}

TEST(LiveSurvey, DoesNotCountAScanThatCannotBePlannedWith) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission());
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    EXPECT_THROW(survey.add({}, "nothing"), Error);
    EXPECT_TRUE(survey.views().empty());
    rehearsal.add_one(survey);
  }
  EXPECT_EQ(rehearsal.open(folder.path()).views().size(), 1U);
}

TEST(LiveSurvey, RefusesWhatItCannotTrust) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission()), other(tests::quick_mission("seed: 2\n"));
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    rehearsal.add_one(survey);
    EXPECT_THAT(complaint_of([&] { rehearsal.open(folder.path()); }), HasSubstr("another skycap"));
  }
  EXPECT_THAT(complaint_of([&] { other.open(folder.path()); }), HasSubstr("seed was 1 and is 2"));

  const fs::path scan = fs::directory_iterator(folder.path() / "scans")->path();
  std::string bytes = content_of(scan);
  bytes.back() ^= 1;
  std::ofstream(scan, std::ios::binary) << bytes;
  EXPECT_THAT(complaint_of([&] { rehearsal.open(folder.path()); }), HasSubstr("is damaged"));
}

/// As from a program that plans otherwise.
TEST(LiveSurvey, NoticesProposalsThatComeOutOtherwise) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission());
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    rehearsal.add_one(survey);
  }
  const fs::path journal = folder.path() / "live.journal";
  std::vector<std::string> records = geometry::read_records(journal).records;
  const std::string field = "\"position\":[";
  records.back().insert(records.back().find(field) + field.size(), "1");
  fs::remove(journal);
  {
    geometry::RecordLog log(journal);
    for (const std::string& record : records) log.append(record);
  }
  EXPECT_THAT(complaint_of([&] { rehearsal.open(folder.path()); }),
              HasSubstr("comes out otherwise"));
}

}  // namespace
}  // namespace skycap::missions::live
