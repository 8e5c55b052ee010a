// E57 files written by Skycap, and their checksums.

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "geometry/io/cloud_io.h"
#include "geometry/io/e57/crc32c.h"
#include "geometry/io/file.h"
#include "tests/geometry/io/e57_reading.h"

namespace skycap::geometry {
namespace {

using namespace testing_support;

// RFC 3720, appendix B.4, and the CRC of "123456789" that CRC catalogues list.
TEST(Crc32c, MatchesPublishedValues) {
  EXPECT_EQ(e57::crc32c("123456789"), 0xE3069283U);
  EXPECT_EQ(e57::crc32c(std::string(32, '\0')), 0x8A9136AAU);
  EXPECT_EQ(e57::crc32c(std::string(32, '\xFF')), 0x62A8AB43U);
  std::string ascending;
  for (char byte = 0; byte < 32; ++byte) ascending += byte;
  EXPECT_EQ(e57::crc32c(ascending), 0x46DD794EU);
}

TEST(Crc32c, MatchesDefinitionForAnyLength) {
  std::string bytes;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(e57::crc32c(bytes), slow_crc32c(bytes)) << i;
    bytes += static_cast<char>(i * i * 37);
  }
}

AttributedCloud some_cloud(std::size_t count) {
  AttributedCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<float>(i);
    cloud.positions.emplace_back(0.1F * x, -x, 1.0F / (1.0F + x));
    cloud.normals.emplace_back(0.0F, 0.6F, i % 2 == 0 ? 0.8F : -0.8F);
    cloud.colours.push_back({static_cast<std::uint8_t>(i), 7, static_cast<std::uint8_t>(i / 256)});
  }
  return cloud;
}

// With all attributes, 10,000 points need five packets.
TEST_F(E57, RoundTripsThroughWriter) {
  for (const std::size_t count : {1U, 2U, 43U, 10'000U}) {
    const AttributedCloud cloud = some_cloud(count);
    const auto path = folder_.path() / "written.e57";
    write_cloud(path, make_columns(cloud));
    AttributedCloud read = read_cloud(path);
    EXPECT_EQ(read.positions, cloud.positions) << count;
    EXPECT_EQ(read.normals, cloud.normals) << count;
    EXPECT_EQ(read.colours, cloud.colours) << count;
    write_cloud(path, {.positions = cloud.positions});
    read = read_cloud(path);
    EXPECT_EQ(read.positions, cloud.positions) << count;
    EXPECT_TRUE(read.normals.empty() && read.colours.empty());
  }
}

TEST_F(E57, WritesPagesWithCorrectChecksums) {
  const auto path = folder_.path() / "written.e57";
  write_cloud(path, make_columns(some_cloud(10'000)));
  const std::string bytes = read_file(path);
  EXPECT_EQ(bytes.size() % e57_page, 0U);
  EXPECT_EQ(e57_pages(extract_e57_content(bytes)), bytes);
}

std::vector<std::string> read_guids(const std::filesystem::path& path) {
  const std::string content = extract_e57_content(read_file(path));
  std::vector<std::string> found;
  for (std::size_t offset = 0; (offset = content.find(">{", offset)) != std::string::npos;
       ++offset) {
    found.push_back(content.substr(offset + 1, 38));
    EXPECT_EQ(found.back().back(), '}');
  }
  return found;
}

// The bytes, including the identifiers, depend only on the cloud.
TEST_F(E57, WritesSameBytesForSameCloud) {
  AttributedCloud cloud = some_cloud(100);
  const auto write = [&](const std::string& name) {
    write_cloud(folder_.path() / name, make_columns(cloud));
    return folder_.path() / name;
  };
  const auto first = write("first.e57");
  EXPECT_EQ(read_file(first), read_file(write("second.e57")));
  cloud.colours[50][1] = 8;
  std::vector<std::string> all = read_guids(first);
  for (const std::string& other : read_guids(write("third.e57"))) all.push_back(other);
  EXPECT_EQ(all.size(), 4U);
  std::ranges::sort(all);
  EXPECT_EQ(std::ranges::adjacent_find(all), all.end());
}

}  // namespace
}  // namespace skycap::geometry
