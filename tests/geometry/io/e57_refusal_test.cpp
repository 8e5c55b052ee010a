// Damaged, truncated and malicious E57 files give a one-line error.

#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/geometry/io/e57_reading.h"

namespace skycap::geometry {
namespace {

using testing::HasSubstr;
using namespace testing_support;

TEST_F(E57, RejectsDamagedPages) {
  E57Triples points(500, {1.0, 2.0, 3.0});
  const std::string whole = make_e57_from_points(points);
  ASSERT_GT(whole.size(), 10 * e57_page);
  for (std::size_t page = 0; page * e57_page < whole.size(); ++page) {
    for (const std::size_t offset : {page == 0 ? 300UL : 0UL, 1019UL, 1020UL, 1023UL}) {
      std::string bytes = whole;
      bytes[page * e57_page + offset] = static_cast<char>(bytes[page * e57_page + offset] ^ 0x10);
      EXPECT_THAT(rejection(bytes),
                  HasSubstr("the page at byte " + std::to_string(page * e57_page) +
                            " has a wrong checksum"));
    }
  }
}

/// Replaces the only occurrence of `old` and corrects the checksums.
std::string with(const std::string& bytes, const std::string& old, const std::string& now) {
  std::string content = extract_e57_content(bytes);
  const std::size_t offset = content.find(old);
  EXPECT_NE(offset, std::string::npos) << old;
  content.replace(offset, old.size(), now);
  const std::size_t begin = content.find("<?xml"), end = content.find("</e57Root>") + 11;
  return e57_with_xml(content.substr(0, begin), content.substr(begin, end - begin));
}

/// Replaces the bytes at `offset` and corrects the checksums.
std::string with_bytes(const std::string& bytes, std::size_t offset, const std::string& now) {
  std::string content = extract_e57_content(bytes);
  content.replace(offset, now.size(), now);
  return e57_pages(content);
}

TEST_F(E57, ReportsCauseForInvalidFiles) {
  const std::string whole = make_e57_from_points(three_points);
  const std::string eight(8, '\xFF');
  // Offsets: 0 file header, 48 record header, 80 first packet.
  const struct {
    std::string bytes, message;
  } cases[] = {
      {"", "is not an E57 file"},
      {"ASTM-E57", "is not an E57 file"},
      {with_bytes(whole, 0, "ASTM-E58"), "is not an E57 file"},
      {with_bytes(whole, 8, "\x02"), "is E57 of version 2; it must be 1"},
      {with_bytes(whole, 16, eight), "ends after 1024 of its 18446744073709551615 bytes"},
      {with_bytes(whole, 16, std::string(8, '\0')), "declares 0 bytes"},
      {with_bytes(whole, 40, std::string("\x00\x03\0\0", 4)), "has pages of 768 bytes"},
      {with_bytes(whole, 40, eight), "has pages of 18446744073709551615 bytes"},
      {with_bytes(whole, 24, eight),
       "its XML is at byte 18446744073709551615, which is after its end"},
      {with_bytes(whole, 24, std::string("\xFD\x03\0\0", 4)), "byte 1021, which is in a checksum"},
      {with_bytes(whole, 32, eight), "has XML of 18446744073709551615 bytes"},
      {with_bytes(whole, 32, std::string("\x10\0\0\0", 4)), "has damaged XML at byte"},
      {with(whole, "</data3D>", "</data2D>"), "has damaged XML at byte"},
      {with(with(whole, "<e57Root", "<E57Root"), "</e57Root>", "</E57Root>\n</e57Root>"),
       "has damaged XML"},
      {with(whole, "fileOffset=\"48\"", "fileOffset=\"99999999\""),
       "a scan is at byte 99999999, which is after its end"},
      {with(whole, "fileOffset=\"48\"", "fileOffset=\"-48\""), "has the fileOffset of 'points'"},
      {with(whole, "fileOffset=\"48\"", "fileOffset=\"52\""), "has no records at byte 52"},
      {with(whole, "recordCount=\"3\"", "recordCount=\"9223372036854775808\""),
       "declares 9223372036854775808 points in a scan of"},
      {with(whole, "recordCount=\"3\"", "recordCount=\"99999999999999999999\""),
       "which is not a valid number"},
      {with(whole, "recordCount=\"3\"", "recordCount=\"4\""),
       "ends after 3 of the 4 points of a scan"},
      {with(whole, "recordCount=\"3\"", "recordCount=\"6\""),
       "declares 6 points in a scan of 116 bytes, which has space for at most 4"},
      {with(whole, "cartesianX", "cartesianA"), "has a scan whose points have neither"},
      {with(whole, "type=\"Float\"", "type=\"Blob\""), "a field 'cartesianX' of type 'Blob'"},
      {with(whole, "type=\"Float\"", "type=\"Float\" precision=\"half\""), "of type 'Float'"},
      {with(whole, "type=\"Float\"", "type=\"String\""), "have neither"},
      {with(whole, "type=\"Float\"", "type=\"Integer\" minimum=\"2\" maximum=\"1\""),
       "whose minimum is above its maximum"},
      {with(whole, "type=\"Float\"", "type=\"ScaledInteger\" scale=\"1e999\""),
       "not a valid number"},
      {with(whole, "type=\"Float\"", "type=\"ScaledInteger\" scale=\"inf\""), "is not finite"},
      {with(whole, "type=\"Float\"", "type=\"Integer\" maximum=\"many\""),
       "the maximum of 'cartesianX' 'many', which is not a valid number"},
      {with(whole, "<points", make_pose("2 0 0 0", "") + "<points"),
       "quaternion has length 2.000000"},
      {with(whole, "<points", make_pose("", "nan 0 0") + "<points"),
       "x of a translation that is not"},
      {with_bytes(whole, 48, "\x02"), "has no records at byte 48"},
      {with_bytes(whole, 56, eight), "at byte 48 (not counting checksums) that extends beyond"},
      {with_bytes(whole, 64, eight), "the data of a scan is at byte 18446744073709551615"},
      {with_bytes(whole, 64, std::string(8, '\0')), "E57 is refused for its packets"},
      {with_bytes(whole, 80, "\x03"), "of kind 3; valid kinds are 0, 1 and 2"},
      {with_bytes(whole, 82, "\xFF\xFF"), "of 65536 bytes; its size must be a multiple of 4"},
      {with_bytes(whole, 82, "\x01"), "of 2 bytes; its size must be a multiple of 4"},
      {with_bytes(whole, 84, "\x02"), "that does not contain one stream for each of the 3 fields"},
      {with_bytes(whole, 86, "\xFF\xFF"), "whose streams are longer than the packet"},
      {with_bytes(whole, 80, "\x02"), "ends after 0 of the 3 points of a scan"},
  };
  for (const auto& broken : cases) {
    if (broken.message == "E57 is refused for its packets") {
      EXPECT_FALSE(rejection(broken.bytes).empty());  // the file header is not a valid packet
      continue;
    }
    EXPECT_THAT(rejection(broken.bytes), HasSubstr(broken.message));
  }
}

// A short file that declares any number of points with zero bits each.
TEST_F(E57, RejectsMorePointsThanItsBytesCanContain) {
  E57Scan scan;
  for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"}) {
    scan.streams.push_back(e57_integers(name, 5, 5, {}));
  }
  scan.records = 2;
  EXPECT_THAT(read(make_e57({scan})).positions,
              testing::ElementsAre(Eigen::Vector3d(5, 5, 5), Eigen::Vector3d(5, 5, 5)));
  scan.records = std::uint64_t{1} << 60;
  EXPECT_THAT(rejection(make_e57({scan})), HasSubstr("declares 1152921504606846976 points"));
  // It must not declare so many more points than it has bytes that they exhaust the memory.
  scan.streams[0] = e57_integers("cartesianX", 0, 1, std::vector<std::int64_t>(80'000, 1));
  scan.records = 65'536;
  EXPECT_EQ(read(make_e57({scan})).positions.size(), 65'536U);
  scan.records = 80'000;
  EXPECT_THAT(rejection(make_e57({scan})), HasSubstr("which has space for at most 65536"));
}

TEST_F(E57, IgnoresEntitiesAndDeepNesting) {
  const std::string whole = make_e57_from_points(three_points);
  std::string bomb = "<!DOCTYPE e57Root [<!ENTITY a \"ha\">";
  for (char c = 'b'; c < 'z'; ++c) {
    const std::string before(1, static_cast<char>(c - 1));
    bomb += std::string("<!ENTITY ") + c + " \"&" + before + ";&" + before + ";\">";
  }
  bomb += "<!ENTITY file SYSTEM \"file:///etc/passwd\">]>";
  EXPECT_EQ(read(with(with(whole, "\n<e57Root", bomb + "<e57Root"), "<data3D",
                      "<guid>&y;&file;</guid><data3D"))
                .positions.size(),
            3U);
  std::string deep;
  for (int i = 0; i < 200'000; ++i) deep += "<a>";
  EXPECT_THAT(rejection(with(whole, "<data3D", deep + "<data3D")), HasSubstr("damaged XML"));
  for (int i = 0; i < 200'000; ++i) deep += "</a>";
  EXPECT_EQ(read(with(whole, "<data3D", deep + "<data3D")).positions.size(), 3U);
}

TEST_F(E57, RejectsTruncatedFiles) {
  const std::string whole = make_e57_from_points(E57Triples(300, {1, 2, 3}));
  ASSERT_FALSE(whole.empty());
  for (std::size_t size = 0; size < whole.size(); size += 101) {
    EXPECT_NE(rejection(whole.substr(0, size)), "") << size;
  }
}

// Checksums are valid, so that the changes reach the parsers.
TEST_F(E57, ReadsOrRejectsChangedBytes) {
  E57Scan scan{
      {e57_integers("cartesianX", -9, 9, {1, 2, 3, 4, 5}),
       e57_singles("cartesianY", {1, 2, 3, 4, 5}),
       e57_integers("cartesianZ", 0, 1000, {1, 2, 3, 4, 5}, "ScaledInteger", "scale=\"2\""),
       e57_integers("cartesianInvalidState", 0, 2, {0, 0, 1, 0, 0})},
      5,
      make_pose("1 0 0 0", "1 2 3"),
      3,
      true};
  const std::string content = extract_e57_content(make_e57({scan}));
  std::mt19937_64 random(1);
  int rejected = 0, read_whole = 0;
  for (int change = 0; change < 1000; ++change) {
    std::string bytes = content;
    // The binary part is a tenth of the file and gets half of the changes.
    const std::size_t end = change % 2 == 0 ? 300 : bytes.size();
    for (int i = 0; i < 2; ++i) bytes[random() % end] = static_cast<char>(random());
    ++(rejection(e57_pages(bytes)).empty() ? read_whole : rejected);
  }
  EXPECT_GE(rejected, 100);
  EXPECT_GE(read_whole, 100);
}

}  // namespace
}  // namespace skycap::geometry
