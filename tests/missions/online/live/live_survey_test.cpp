#include "missions/online/live/live_survey.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/record_log.h"
#include "missions/online/live/answer.h"
#include "missions/support/sha256.h"
#include "tests/missions/online/live/rehearsal.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/complaint.h"

namespace skycap::missions::online {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing_support::thrown_message;
using tests::read_content;

TEST(LiveSurvey, MatchesPlanWithSimulatedScans) {
  for (const std::string& mission :
       {short_mission(tests::quick_mission(), "see++"), short_mission(tests::quick_mission(), "oa"),
        short_mission(tests::flight_mission()), moving_mission("live: {pose_check: false}\n")}) {
    const tests::TestFolder folder;
    const Rehearsal rehearsal(mission);
    LiveSurvey survey = rehearsal.open(folder.path());
    Platform platform(rehearsal);
    while (survey.proposal().view) platform.add_next(survey);
    const session::SurveyRecord planned = rehearsal.planned();
    EXPECT_EQ(planned.en_route_frames() > 0, rehearsal.setup().sensor().is_moving());
    expect_same(survey.finish(), planned);
  }
}

TEST(LiveSurvey, ResumesAfterEveryScan) {
  for (const std::string& mission :
       {short_mission(tests::quick_mission(), "see++"), short_mission(tests::flight_mission()),
        moving_mission("live: {pose_check: false}\n", /*views=*/2)}) {
    const tests::TestFolder folder;
    const Rehearsal rehearsal(mission);
    Platform platform(rehearsal);
    while (rehearsal.open(folder.path()).proposal().view) {
      LiveSurvey survey = rehearsal.open(folder.path());
      platform.add_next(survey);
    }
    expect_same(rehearsal.open(folder.path()).finish(), rehearsal.planned());
  }
}

/// A kill leaves any prefix of the journal, and possibly a scan that is not in the journal.
TEST(LiveSurvey, ResumesFromAnyPrefixOfJournal) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(short_mission(tests::quick_mission(), "see++"));
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    for (int i = 0; i < 5; ++i) rehearsal.add_one(survey);
  }
  const fs::path journal = folder.path() / "live.journal";
  const std::string whole = read_content(journal);
  const session::SurveyRecord planned = rehearsal.planned();
  constexpr std::size_t parts = 9;
  for (std::size_t part = 0; part <= parts; ++part) {
    std::ofstream(journal, std::ios::binary) << whole.substr(0, part * whole.size() / parts);
    LiveSurvey survey = rehearsal.open(folder.path());
    while (survey.proposal().view) rehearsal.add_one(survey);
    expect_same(survey.finish(), planned);
  }
}

TEST(LiveSurvey, IgnoresKnownScan) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission());
  LiveSurvey survey = rehearsal.open(folder.path());
  const geometry::Scan scan = rehearsal.scan(survey);
  EXPECT_TRUE(survey.add(scan, "a"));
  const Proposal before = survey.proposal();
  EXPECT_FALSE(survey.add(scan, "a"));
  EXPECT_EQ(survey.scan_number("a"), ScanNumber{0});
  EXPECT_EQ(survey.scan_number("b"), std::nullopt);
  EXPECT_EQ(survey.views().size(), 1U);
  EXPECT_EQ(survey.proposal().view->position, before.view->position);
}

TEST(LiveSurvey, KeepsRejectedViewsAfterReopening) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission());
  Eigen::Vector3d first, second;
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    EXPECT_THAT(testing_support::thrown_message([&] { survey.reject("too early"); }),
                testing::HasSubstr("no view to reject"));
    rehearsal.add_one(survey);
    first = survey.proposal().view->position;
    survey.reject("behind the fence");
    ASSERT_TRUE(survey.proposal().view);
    second = survey.proposal().view->position;
    EXPECT_NE(first, second);
  }
  const LiveSurvey survey = rehearsal.open(folder.path());
  EXPECT_EQ(survey.proposal().view->position, second);
  EXPECT_EQ(survey.proposal().number, 2U);
}

TEST(LiveSurvey, IgnoresUnusableFirstScan) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission());
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    EXPECT_THAT(testing_support::thrown_message([&] { survey.add({}, "nothing"); }),
                testing::HasSubstr("the first scan contains no point of the scene"));
    EXPECT_TRUE(survey.views().empty());
    rehearsal.add_one(survey);
  }
  EXPECT_EQ(rehearsal.open(folder.path()).views().size(), 1U);
}

/// Returns a pose error of `shift` [m] along x and `turn_deg` degrees about the sensor's x axis.
Eigen::Isometry3d make_error(const geometry::Scan& scan, double shift, double turn_deg) {
  Eigen::Isometry3d error = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d sensor = scan.sensor_position();
  error.linear() = Eigen::AngleAxisd(turn_deg * geometry::radians_per_degree,
                                     scan.world_from_sensor.linear().col(0))
                       .toRotationMatrix();
  error.translation() = sensor + Eigen::Vector3d(shift, 0.0, 0.0) - error.linear() * sensor;
  return error;
}

geometry::Scan displaced(const geometry::Scan& scan, double shift, double turn_deg) {
  return corrected(scan, make_error(scan, shift, turn_deg));
}

TEST(LiveSurvey, IsUnaffectedByRejectedScans) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(fine_mission());
  std::size_t wrong = 0;
  while (true) {
    LiveSurvey survey = rehearsal.open(folder.path());
    EXPECT_EQ(survey.set_aside(), wrong);
    EXPECT_EQ(survey.proposal().has_pose_warning(), false);
    if (!survey.proposal().view) break;
    if (survey.views().size() > 0) {
      const Proposal before = survey.proposal();
      EXPECT_TRUE(survey.add(displaced(rehearsal.scan(survey), 0.1, 1.0), std::to_string(wrong)));
      ++wrong;
      EXPECT_FALSE(
          survey.add(displaced(rehearsal.scan(survey), 0.1, 1.0), std::to_string(wrong - 1)));
      ASSERT_TRUE(survey.proposal().has_pose_warning()) << survey.views().size();
      EXPECT_EQ(survey.proposal().number, before.number + 1);
      EXPECT_EQ(survey.proposal().view->position, before.view->position);
    }
    rehearsal.add_one(survey);
  }
  const session::SurveyRecord planned = rehearsal.planned();
  ASSERT_GT(planned.views.size(), 2U);
  EXPECT_EQ(wrong, planned.views.size() - 1);
  expect_same(rehearsal.open(folder.path()).finish(), planned);
}

TEST(LiveSurvey, KeepsPoseWarningUntilScanIsUsed) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(fine_mission());
  std::string answer;
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    rehearsal.add_one(survey);
    survey.add(displaced(rehearsal.scan(survey), 0.1, 1.0), "wrong");
    survey.reject("elsewhere");
    answer = answer_json(survey, rehearsal.setup().flight());
    EXPECT_THAT(answer, HasSubstr("\"warning\":\"pose\""));
    EXPECT_THAT(answer, HasSubstr("\"rejected\":1"));
  }
  LiveSurvey survey = rehearsal.open(folder.path());
  EXPECT_EQ(answer_json(survey, rehearsal.setup().flight()), answer);
  rehearsal.add_one(survey);
  EXPECT_THAT(answer_json(survey, rehearsal.setup().flight()), Not(HasSubstr("warning")));
}

TEST(LiveSurvey, ProposesNoPathAfterPoseWarning) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(short_mission(tests::flight_mission()));
  LiveSurvey survey = rehearsal.open(folder.path());
  rehearsal.add_one(survey);
  EXPECT_FALSE(survey.proposal().path.points.empty());
  survey.add(displaced(rehearsal.scan(survey), 2.0, 5.0), "wrong");
  ASSERT_TRUE(survey.proposal().has_pose_warning());
  EXPECT_TRUE(survey.proposal().path.points.empty());
  survey.reject("elsewhere");
  EXPECT_TRUE(survey.proposal().path.points.empty());
  rehearsal.add_one(survey);
  EXPECT_FALSE(survey.proposal().path.points.empty());
}

/// While the pose is unknown there is no path. The next scan that fits restores it.
TEST(LiveSurvey, RestoresPathAfterWrongEnRoutePose) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(moving_mission());
  std::string answer;
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    Platform platform(rehearsal);
    platform.add_next(survey);
    const std::vector<Eigen::Vector3d> path = survey.proposal().path.points;
    const geometry::View view = *survey.proposal().view;
    survey.add_en_route(displaced(platform.next(survey).scan, 2.0, 5.0), "wrong");
    ASSERT_TRUE(survey.proposal().has_pose_warning());
    EXPECT_TRUE(survey.proposal().path.points.empty());
    EXPECT_EQ(survey.en_route(), 0U);
    EXPECT_EQ(survey.proposal().view->position, view.position);
    EXPECT_EQ(rehearsal.open(folder.path() / "other").en_route(), 0U);
  }
  LiveSurvey survey = rehearsal.open(folder.path());
  EXPECT_TRUE(survey.proposal().path.points.empty());
  EXPECT_EQ(survey.set_aside(), 1U);
  const geometry::View view = *survey.proposal().view;
  geometry::View between = view;
  between.position = 0.5 * (view.position + survey.views().back().view.position);
  simulation::MountedSensor sensor(rehearsal.setup().simulation, 1);
  survey.add_en_route(rehearsal.scan(sensor, {.view = between}, 2), "right");
  EXPECT_FALSE(survey.proposal().has_pose_warning());
  EXPECT_EQ(survey.en_route(), 1U);
  ASSERT_FALSE(survey.proposal().path.points.empty());
  EXPECT_EQ(survey.proposal().path.points.back(), view.position);
  // A path requested now starts at the current position of the vehicle.
  survey.reject("elsewhere");
  ASSERT_FALSE(survey.proposal().path.points.empty());
  EXPECT_LT((survey.proposal().path.points.front() - between.position).norm(), 1e-9);
}

TEST(LiveSurvey, RejectsEnRouteScansWithoutMovingCapture) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(short_mission(tests::flight_mission()));
  LiveSurvey survey = rehearsal.open(folder.path());
  rehearsal.add_one(survey);
  EXPECT_TRUE(survey.frames().empty());
  const geometry::Scan scan = rehearsal.scan(survey);
  EXPECT_THAT(thrown_message([&] { survey.add_en_route(scan, "a"); }),
              HasSubstr("en-route scans require sensor.capture: moving"));
}

// The walls and roofs of houses constrain all directions and are large compared with the patches. A
// teapot is too round.
TEST(LiveSurvey, RepeatsPoseCorrectionsAfterReopening) {
  const tests::TestFolder folder;
  std::string houses = fine_mission(
      "live: {registration: true, pose_sigma: 0.02, pose_sigma_deg: 0.5}\n"
      "start: {position: [6, -5, 6], look_at: [0, 0, 1]}\n");
  houses.replace(houses.find("builtin:teapot"), 14, "builtin:city-block");
  houses.replace(houses.find("longest_side: 1.0"), 17, "longest_side: 8.0");
  const Rehearsal rehearsal(houses);
  std::string answer;
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    const geometry::Scan scan = rehearsal.scan(survey);
    rehearsal.add_one(survey);
    const Eigen::Isometry3d error = make_error(scan, 0.03, 0.5);
    survey.add(corrected(scan, error), "from the same place");
    answer = answer_json(survey, rehearsal.setup().flight());
    ASSERT_TRUE(survey.proposal().pose->correction) << answer;
    const Eigen::Isometry3d left = *survey.proposal().pose->correction * error;
    const Eigen::Vector3d sensor = scan.sensor_position();
    EXPECT_LT((left * sensor - sensor).norm(), 0.01) << answer;
    EXPECT_LT(Eigen::AngleAxisd(left.linear()).angle(), 0.1 * geometry::radians_per_degree);
  }
  const LiveSurvey survey = rehearsal.open(folder.path());
  EXPECT_EQ(answer_json(survey, rehearsal.setup().flight()), answer);
  EXPECT_THAT(answer, HasSubstr("\"corrected\":true"));
}

TEST(LiveSurvey, AcceptsPosesUncheckedWhenConfigured) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(fine_mission("live: {pose_check: false}\n"));
  LiveSurvey survey = rehearsal.open(folder.path());
  rehearsal.add_one(survey);
  survey.add(displaced(rehearsal.scan(survey), 0.1, 1.0), "wrong");
  EXPECT_EQ(survey.views().size(), 2U);
  EXPECT_FALSE(survey.proposal().pose);
}

TEST(LiveSurvey, AcceptsChangedMissionBeforeFirstScan) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission()), other(tests::quick_mission("seed: 2\n"));
  rehearsal.open(folder.path());
  {
    LiveSurvey survey = other.open(folder.path());
    other.add_one(survey);
  }
  EXPECT_EQ(other.open(folder.path()).views().size(), 1U);
  EXPECT_THAT(thrown_message([&] { rehearsal.open(folder.path()); }),
              HasSubstr("seed changed from 2 to 1"));
}

TEST(LiveSurvey, RejectsLockedChangedOrDamagedFolder) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission()), other(tests::quick_mission("seed: 2\n"));
  {
    LiveSurvey survey = rehearsal.open(folder.path());
    rehearsal.add_one(survey);
    EXPECT_THAT(thrown_message([&] { rehearsal.open(folder.path()); }),
                HasSubstr("another skycap"));
  }
  EXPECT_THAT(thrown_message([&] { other.open(folder.path()); }),
              HasSubstr("seed changed from 1 to 2"));

  const fs::path scan = fs::directory_iterator(folder.path() / "scans")->path();
  std::string bytes = read_content(scan);
  bytes.back() ^= 1;
  std::ofstream(scan, std::ios::binary) << bytes;
  EXPECT_THAT(thrown_message([&] { rehearsal.open(folder.path()); }), HasSubstr("is damaged"));
}

void write_records(const fs::path& journal, const std::vector<std::string>& records) {
  fs::remove(journal);
  geometry::RecordLog log(journal);
  for (const std::string& record : records) log.append(record);
}

TEST(LiveSurvey, RejectsJournalOfOtherFormatNamingItsVersion) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(tests::quick_mission());
  rehearsal.open(folder.path());
  const fs::path journal = folder.path() / "live.journal";
  std::vector<std::string> records = geometry::read_records(journal).records;
  auto identity = nlohmann::ordered_json::parse(records.at(0));
  identity["version"] = "0.1.0";
  identity.erase("format");
  records[0] = identity.dump();
  write_records(journal, records);
  EXPECT_THAT(thrown_message([&] { rehearsal.open(folder.path()); }),
              HasSubstr("was written by version 0.1.0, whose journals cannot be resumed by this "
                        "version; use another folder"));
}

/// Replaces the only scan in a survey's folder and its digest in the journal.
void replace_scan(const fs::path& folder, const std::string& bytes) {
  const fs::path scan = fs::directory_iterator(folder / "scans")->path(),
                 journal = folder / "live.journal";
  const std::string digest = support::compute_file_sha256(scan);
  std::ofstream(scan, std::ios::binary) << bytes;
  std::vector<std::string> records = geometry::read_records(journal).records;
  for (std::string& record : records) {
    const std::size_t at = record.find(digest);
    if (at != std::string::npos)
      record.replace(at, digest.size(), support::compute_file_sha256(scan));
  }
  write_records(journal, records);
}

/// A manipulated folder with valid digests.
TEST(LiveSurvey, RejectsInvalidStoredScans) {
  const Rehearsal rehearsal(tests::quick_mission());
  const auto error_message = [&](const std::string& part, const std::string& to) {
    const tests::TestFolder folder;
    {
      LiveSurvey survey = rehearsal.open(folder.path());
      rehearsal.add_one(survey);
    }
    std::string bytes = read_content(fs::directory_iterator(folder.path() / "scans")->path());
    // The last four bytes are the last pixel.
    const std::size_t at = part.empty() ? bytes.size() - to.size() : bytes.find(part);
    bytes.replace(at, to.size(), to);
    replace_scan(folder.path(), bytes);
    return thrown_message([&] { rehearsal.open(folder.path()); });
  };
  EXPECT_THAT(error_message("float y", "float w"),
              HasSubstr(".ply: is not a scan file of a survey"));
  EXPECT_THAT(error_message("", "\xff\xff\xff\x7f"), HasSubstr(".ply: cannot be used: "));
}

/// As if the journal came from a program that plans differently.
TEST(LiveSurvey, RejectsDifferingProposals) {
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
  write_records(journal, records);
  EXPECT_THAT(thrown_message([&] { rehearsal.open(folder.path()); }),
              HasSubstr("differs from the recorded one"));
}

}  // namespace
}  // namespace skycap::missions::online
