#include "missions/online/recordings/recorded_sequence.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"

namespace skycap::missions::online {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::thrown_message;

constexpr std::size_t all = 1000;

class Recording : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  /// Writes a sequence with three images and these poses.
  void write_tum(const std::string& poses) const {
    for (const char* name : {"a.png", "b.png", "c.png"}) write(name, "");
    write("depth.txt", "# depth maps\n1.00 a.png\n1.10 b.png\n1.20 c.png\n");
    write("groundtruth.txt", poses);
  }
  RecordedSequence read(std::size_t count = all) const {
    return read_sequence(folder_.path(), count);
  }
  std::string error_message() const {
    return thrown_message([&] { read(); });
  }
  static std::vector<std::string> ids(const RecordedSequence& sequence) {
    std::vector<std::string> ids;
    for (const RecordedFrame& frame : sequence.frames) ids.push_back(frame.id);
    return ids;
  }

  tests::TestFolder folder_;
};

TEST_F(Recording, PairsTumImagesAndPosesByTime) {
  write_tum("#t x y z qx qy qz qw\n0.99 1 2 3 0 0 0 1\n1.115 4 5 6 0 0 0 1\n1.125 7 8 9 0 0 0 1\n");
  const RecordedSequence sequence = read();
  EXPECT_THAT(ids(sequence), ElementsAre("1.00", "1.10"));
  EXPECT_EQ(sequence.frames[0].world_from_sensor.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(sequence.frames[1].world_from_sensor.translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(sequence.frames[1].file, folder_.path() / "b.png");
  EXPECT_THAT(sequence.notes,
              ElementsAre(AllOf(HasSubstr("1.20 is skipped"), HasSubstr("no pose within 20 ms"),
                                HasSubstr("0.075 s off"))));
}

// Trackers that correct a pose write it again with the same time.
TEST_F(Recording, UsesLastOfLinesWithSameTime) {
  write_tum(
      "1.00 0 0 0 0 0 0 1\n1.000 5 0 0 0 0 0 1\n1.10 1 0 0 0 0 0 1\n1.10 2 0 0 0 0 0 1\n"
      "1.10 3 0 0 0 0 0 1\n1.20 9 0 0 0 0 0 1\n");
  const RecordedSequence sequence = read();
  EXPECT_THAT(ids(sequence), ElementsAre("1.00", "1.10", "1.20"));
  EXPECT_EQ(sequence.frames[0].world_from_sensor.translation().x(), 5.0);
  EXPECT_EQ(sequence.frames[1].world_from_sensor.translation().x(), 3.0);
  EXPECT_THAT(sequence.remarks,
              ElementsAre(AllOf(
                  HasSubstr("groundtruth.txt"),
                  HasSubstr("lines ignored because a later line has the same timestamp: 3"))));
}

// Lists as Windows programs write them: byte order mark, backslashes, quotes and CRLF line ends.
TEST_F(Recording, ReadsListsFromWindowsPrograms) {
  write_tum(
      "\xEF\xBB\xBF"
      "1.00 0 0 0 0 0 0 1\r\n1.10 0 0 0 0 0 0 1\r\n1.20 0 0 0 0 0 0 1\r\n");
  std::filesystem::create_directory(folder_.path() / "depth");
  for (const char* name : {"a.png", "b.png", "c.png"}) write(std::string("depth/") + name, "");
  write("depth.txt",
        "\xEF\xBB\xBF"
        "1.00 depth\\a.png\r\n1.10 \"depth/b.png\"\r\n1.20 'depth\\c.png'\r\n");
  const RecordedSequence sequence = read();
  EXPECT_THAT(sequence.notes, testing::IsEmpty());
  ASSERT_THAT(ids(sequence), ElementsAre("1.00", "1.10", "1.20"));
  EXPECT_EQ(sequence.frames[0].file, folder_.path() / "depth/a.png");
  EXPECT_EQ(sequence.frames[2].file, folder_.path() / "depth/c.png");
}

TEST_F(Recording, EndsAtMaxFrames) {
  write_tum("1.00 0 0 0 0 0 0 1\n1.10 0 0 0 0 0 0 1\n1.20 0 0 0 0 0 0 1\n");
  EXPECT_THAT(ids(read(2)), ElementsAre("1.00", "1.10"));
}

TEST_F(Recording, ReportsInvalidFrames) {
  write_tum("1.00 0 0 0 0 0 0 1\n1.10 0 0 0 0 0 0 3\n1.20 0 0 0 0 0 0 1\n");
  std::filesystem::remove(folder_.path() / "c.png");
  const RecordedSequence sequence = read();
  EXPECT_THAT(ids(sequence), ElementsAre("1.00"));
  EXPECT_THAT(sequence.notes,
              ElementsAre(AllOf(HasSubstr("groundtruth.txt: time 1.10"), HasSubstr("quaternion")),
                          HasSubstr("c.png: does not exist")));
}

TEST_F(Recording, RejectsDecreasingTimes) {
  write_tum("1.00 0 0 0 0 0 0 1\n0.90 0 0 0 0 0 0 1\n");
  EXPECT_THAT(error_message(), AllOf(HasSubstr("groundtruth.txt: line 2"), HasSubstr("0.90")));
  write("groundtruth.txt", "now 0 0 0 0 0 0 1\n");
  EXPECT_THAT(error_message(), HasSubstr("expected a time, found 'now'"));
}

TEST_F(Recording, ReadsSevenScenesPoseFiles) {
  for (const char* frame : {"frame-000010", "frame-000005", "frame-000000", "frame-000015"}) {
    write(std::string(frame) + ".depth.png", "");
  }
  write("frame-000000.pose.txt", "1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n");
  write("frame-000005.pose.txt", "1 0 0 4\n0 1 0 5\n0 0 1 6\n0 0 0 1\n");
  write("frame-000010.pose.txt", "2 0 0 4\n0 2 0 5\n0 0 2 6\n0 0 0 1\n");
  const RecordedSequence sequence = read();
  EXPECT_THAT(ids(sequence), ElementsAre("frame-000000", "frame-000005"));
  EXPECT_EQ(sequence.frames[1].world_from_sensor.translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_THAT(sequence.notes,
              ElementsAre(HasSubstr("without scale"), HasSubstr("frame-000015.pose.txt")));
}

TEST_F(Recording, RejectsInvalidInput) {
  EXPECT_THAT(error_message(), HasSubstr("contains neither depth.txt and groundtruth.txt"));
  EXPECT_THAT(thrown_message([&] { read_sequence(folder_.path() / "x", all); }),
              HasSubstr("is not a folder"));
  write("depth.txt", "1.0 a.png\n");
  EXPECT_THAT(error_message(), HasSubstr("groundtruth.txt"));
  write("groundtruth.txt", "");
  EXPECT_THAT(error_message(), HasSubstr("has no usable frame"));
}

}  // namespace
}  // namespace skycap::missions::online
