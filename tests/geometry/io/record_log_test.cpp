#include "geometry/io/record_log.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class RecordLogFile : public testing::Test {
 protected:
  /// Creates a file with three records.
  RecordLogFile() {
    RecordLog log(file_);
    for (const char* text : {"one", "", "three {\"3\": 0.1}"}) log.append(text);
  }

  std::string bytes() const { return read_file(file_); }
  void put(const std::string& bytes) const { write_file(file_, bytes); }

  testing_support::TemporaryFolder folder_;
  fs::path file_ = folder_.path() / "log";
};

TEST_F(RecordLogFile, ReturnsAppendedRecords) {
  EXPECT_THAT(read_records(file_).records, ElementsAre("one", "", "three {\"3\": 0.1}"));
  RecordLog log(file_);
  log.append("four");
  EXPECT_THAT(read_records(file_).records, ElementsAre("one", "", "three {\"3\": 0.1}", "four"));
}

TEST_F(RecordLogFile, NumbersRecordsFromOneAfterClear) {
  {
    RecordLog log(file_);
    log.clear();
    EXPECT_THAT(log.records(), IsEmpty());
    log.append("first");
  }
  EXPECT_THAT(read_records(file_).records, ElementsAre("first"));
}

/// The checksum of the first record was computed with Python's zlib.crc32(b"1 one").
TEST_F(RecordLogFile, UsesZlibCrc32) { EXPECT_THAT(bytes(), HasSubstr("7f7c96f6 1 one\n")); }

TEST(RecordLog, IsEmptyWithoutFile) {
  const testing_support::TemporaryFolder folder;
  EXPECT_THAT(read_records(folder.path() / "log").records, IsEmpty());
}

/// A kill during the write of the last record may leave any prefix of it.
TEST_F(RecordLogFile, DiscardsIncompleteLastRecord) {
  const std::string whole = bytes();
  const std::size_t two_records = whole.find("three") - std::string("12345678 3 ").size();
  for (std::size_t size = two_records; size < whole.size(); ++size) {
    put(whole.substr(0, size));
    EXPECT_EQ(read_records(file_).torn_bytes, size - two_records);
    RecordLog log(file_);
    EXPECT_THAT(log.records(), ElementsAre("one", "")) << size;
    log.append("other");
    EXPECT_THAT(read_records(file_).records, ElementsAre("one", "", "other")) << size;
  }
}

/// A power failure may leave a block of zeros or of old disk contents.
TEST_F(RecordLogFile, DiscardsGarbageAtEnd) {
  const std::string whole = bytes();
  put(whole + std::string(5000, '\0'));
  EXPECT_EQ(RecordLog(file_).records().size(), 3);
  put(whole + "deadbeef 4 four\n\nx\n12345678 \n");
  EXPECT_EQ(RecordLog(file_).records().size(), 3);
  EXPECT_EQ(bytes(), whole);
}

TEST_F(RecordLogFile, DetectsEveryChangedByteBeforeLastRecord) {
  const std::string whole = bytes();
  const std::size_t two_records = whole.find("three") - std::string("12345678 3 ").size();
  for (std::size_t at = 0; at + 1 < two_records; ++at) {
    std::string changed = whole;
    changed[at] ^= 1;
    put(changed);
    EXPECT_THAT(testing_support::thrown_message([&] { read_records(file_); }),
                testing::HasSubstr("log: line "))
        << at;
  }
}

TEST_F(RecordLogFile, DetectsMissingOrRepeatedRecord) {
  const std::string whole = bytes();
  const std::string second =
      whole.substr(whole.find('\n') + 1, std::string("12345678 2 \n").size());
  for (const std::string& with : {std::string(), second + second}) {
    std::string changed = whole;
    put(changed.replace(changed.find(second), second.size(), with));
    try {
      read_records(file_);
      FAIL();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(with.empty() ? "log: line 2 is" : "log: line 3 is"));
    }
  }
}

TEST_F(RecordLogFile, RejectsSecondWriter) {
  const RecordLog log(file_);
  try {
    RecordLog second(file_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("another skycap"));
  }
}

TEST(RecordLog, RejectsMissingFolder) {
  EXPECT_THAT(testing_support::thrown_message([&] { RecordLog("/nowhere/to/be/found/log"); }),
              testing::HasSubstr("/nowhere/to/be/found/log: "));
}

}  // namespace
}  // namespace skycap::geometry
