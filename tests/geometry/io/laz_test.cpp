// LAZ files. LASzip 3.5, the reference compressor, created them from points computed by a formula
// that is repeated here. various_chunks.laz has chunks of 70, 13, 1 and 216 points.

#include <cstring>
#include <fstream>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/cloud_sample.h"
#include "geometry/io/las/las_reader.h"
#include "tests/support/temporary_folder.h"

namespace skycap::geometry {
namespace {

using testing::HasSubstr;
using testing_support::TemporaryFolder;

constexpr int point_count = 300;

std::string find_test_file(const std::string& name) {
  return std::string(LAZ_FILES) + "/" + name + ".laz";
}

std::string read_bytes(const std::string& name) {
  std::ifstream stream(find_test_file(name), std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

Eigen::Vector3d make_position(int i) {
  const int jump = i % 97 == 96 ? 1'500'000 : 0;
  return {(40 * i + i * i % 23 + jump) * 0.01, (i * 37 % 1001 - 500) * 0.01,
          (i / 10 * 3 + i % 4 * 150) * 0.001};
}

std::array<std::uint16_t, 3> make_colour(int i) {
  const int red = 256 * (i % 200) + i % 7;
  const int green = i % 3 == 0 ? red : 65535 - red;
  const int blue = i % 3 == 0 ? red : (green + i) % 65536;
  const auto word = [](int channel) { return static_cast<std::uint16_t>(channel); };
  return {word(red), word(green), word(blue)};
}

/// Reads chunks of this size and compares the points with the formula. Every 60th point is
/// withheld.
void expect_formula(LasReader& reader, std::size_t chunk) {
  LasPoints points;
  int i = 0;
  while (reader.next(points, chunk)) {
    ASSERT_EQ(points.classes.size(), points.positions.size());
    for (std::size_t k = 0; k < points.positions.size(); ++k, ++i) {
      if (i % 60 == 59) ++i;
      ASSERT_EQ(points.positions[k], make_position(i)) << i;
      ASSERT_EQ(points.classes[k], 2 + i / 50 % 4) << i;
      if (!reader.header().has_colours()) continue;
      ASSERT_EQ(points.colours[k], make_colour(i)) << i;
    }
  }
  EXPECT_EQ(i, point_count - 1);  // the last point is withheld
}

class Laz : public testing::TestWithParam<const char*> {};

TEST_P(Laz, ReadsFilesOfReferenceCompressor) {
  for (const std::size_t chunk : {1, 7, 1000}) {
    SCOPED_TRACE(chunk);
    LasReader reader(find_test_file(GetParam()));
    EXPECT_TRUE(reader.header().is_compressed);
    ASSERT_EQ(reader.header().points, point_count);
    expect_formula(reader, chunk);
  }
}

TEST_P(Laz, ReadsCloud) {
  const AttributedCloud cloud = read_cloud(find_test_file(GetParam()));
  ASSERT_EQ(cloud.positions.size(), point_count - 5U);
  EXPECT_TRUE(cloud.positions[7].isApprox(make_position(7).cast<float>()));
  std::vector<Eigen::Vector3f> positions;
  read_positions(find_test_file(GetParam()), [&](std::span<const Eigen::Vector3f> chunk, double) {
    positions.insert(positions.end(), chunk.begin(), chunk.end());
  });
  EXPECT_EQ(positions, cloud.positions);
}

TEST_P(Laz, SamplesPartOfEachChunk) {
  const std::string file = find_test_file(GetParam());
  const AttributedCloud cloud = read_cloud(file);
  const CloudSample whole = sample_las_cloud(file, 1000);
  EXPECT_EQ(whole.cloud.positions, cloud.positions);
  EXPECT_EQ(whole.cloud.colours, cloud.colours);
  EXPECT_EQ(whole.of, cloud.positions.size());
  EXPECT_EQ(whole.offset, Eigen::Vector3d::Zero());
  const CloudSample sample = sample_las_cloud(file, 60);
  EXPECT_EQ(sample.of, point_count);
  EXPECT_GE(sample.cloud.positions.size(), 50U);
  EXPECT_LE(sample.cloud.positions.size(), 64U);  // at least one point of each of four chunks
  EXPECT_EQ(sample.cloud.colours.empty(), cloud.colours.empty());
  std::size_t at = 0;  // the points are in the order of the file
  for (const Eigen::Vector3f& position : sample.cloud.positions) {
    while (at < cloud.positions.size() && cloud.positions[at] != position) ++at;
    ASSERT_LT(at++, cloud.positions.size());
  }
}

/// Returns true if reading ends with a one-line error that names the file, false if points are
/// read.
bool is_rejected(const TemporaryFolder& folder, const std::string& bytes) {
  try {
    LasReader reader(folder.file("spoiled.laz", bytes));
    LasPoints points;
    std::uint64_t read = 0;
    while (reader.next(points)) read += points.positions.size();
    EXPECT_LE(read, reader.header().points);
    return false;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("spoiled.laz: "));
    EXPECT_EQ(error.kind(), ErrorKind::bad_file);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return true;
  }
}

TEST_P(Laz, RejectsTruncatedFiles) {
  const TemporaryFolder folder;
  const std::string whole = read_bytes(GetParam());
  // The chunk table is at the end of the file. It is padded, so its last bytes may be missing.
  ASSERT_GT(whole.size(), 12U);
  for (std::size_t size = 0; size + 12 < whole.size(); size += 61) {
    EXPECT_TRUE(is_rejected(folder, whole.substr(0, size))) << size;
  }
}

TEST_P(Laz, ReadsOrRejectsChangedBytes) {
  const TemporaryFolder folder;
  const std::string whole = read_bytes(GetParam());
  std::mt19937_64 random(1);
  int rejected = 0, read = 0;
  for (int change = 0; change < 250; ++change) {
    std::string bytes = whole;
    for (int i = 0; i < 1 + change % 3; ++i) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    ++(is_rejected(folder, bytes) ? rejected : read);
  }
  EXPECT_GT(rejected, 10);
  EXPECT_GT(read, 3) << "else no change got past the first check";
}

INSTANTIATE_TEST_SUITE_P(Formats, Laz,
                         testing::Values("format0", "format1", "format2", "format3", "format6",
                                         "format7", "format8", "various_chunks"),
                         [](const auto& file) { return std::string(file.param); });

class CorruptedLaz : public testing::Test {
 protected:
  /// Checks the error message for a file with a changed value at `offset`.
  template <typename Value>
  void expect_rejection(std::size_t offset, Value value, const std::string& message) const {
    std::string bytes = whole_;
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    EXPECT_THAT(
        [&] {
          LasReader reader(folder_.file("a.laz", bytes));
          LasPoints points;
          while (reader.next(points)) {
          }
        },
        testing::ThrowsMessage<Error>(testing::AllOf(HasSubstr("a.laz: "), HasSubstr(message))));
  }

  const TemporaryFolder folder_;
  const std::string whole_ = read_bytes("format7");
  // Offsets of the LASzip record, the points and the chunk table.
  const std::size_t record_ = whole_.find("laszip encoded") + 52;
  const std::size_t points_ = record_ + 34 + 2 * 6;
  const std::size_t table_ = [this] {
    std::uint64_t offset = 0;
    std::memcpy(&offset, whole_.data() + points_, sizeof offset);
    return offset;
  }();
};

TEST_F(CorruptedLaz, ReportsUnsupportedCompression) {
  for (const int format : {4, 5, 9, 10}) {
    expect_rejection(
        104, static_cast<std::uint8_t>(0x80 | format),
        "points of format " + std::to_string(format) + ", compressed (LAZ); supported");
  }
  expect_rejection(104, std::uint8_t{0xC7}, "points of format 71, compressed (LAZ); supported");
  expect_rejection(record_ - 54 + 18, std::uint16_t{1}, "the LAZ record is missing");
  expect_rejection(record_ - 54 + 20, std::uint16_t{40}, "it ends prematurely");
  expect_rejection(record_, std::uint16_t{1}, "is compressed by LAZ method 1");
  expect_rejection(record_ + 2, std::uint16_t{1}, "is compressed by LAZ method 3");
  expect_rejection(record_ + 12, std::uint32_t{0}, "its chunk size is zero");
  expect_rejection(record_ + 32, std::uint16_t{1}, "LAZ items do not match point format 7");
  expect_rejection(record_ + 34, std::uint16_t{11}, "LAZ items do not match point format 7");
  expect_rejection(record_ + 38, std::uint16_t{2}, "has LAZ items of version 2");
  expect_rejection(105, std::uint16_t{37}, "LAZ items do not match point format 7 and 37");
}

TEST_F(CorruptedLaz, ReportsInvalidChunkTable) {
  expect_rejection(points_, std::uint64_t{7},
                   "has no valid chunk table: its declared offset (byte 7)");
  expect_rejection(points_, std::uint64_t{1} << 60, "has no valid chunk table");
  expect_rejection(table_, std::uint32_t{1}, "its version is not 0");
  expect_rejection(table_ + 4, std::uint32_t{2}, "has fewer compressed chunks");
  expect_rejection(table_ + 4, std::uint32_t{0}, "has fewer compressed chunks");
  expect_rejection(247, std::uint64_t{1} << 62, "has fewer compressed chunks");
  expect_rejection(points_ + 8 + 36 + 4, std::uint32_t{1} << 31, "extends beyond its chunk");
}

}  // namespace
}  // namespace skycap::geometry
