// LAZ files that Skycap writes. Decoder and encoder share their models, but not the arithmetic
// coder and the choices of the encoder. Files of LASzip (laz_test.cpp) show that the decoder
// follows the specification; these tests show that the encoder writes what the decoder reads.

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/byte_values.h"
#include "geometry/io/las/arithmetic_coder.h"
#include "geometry/io/las/integer_coder.h"
#include "geometry/io/las/las_conversion.h"
#include "geometry/io/las/las_file_writer.h"
#include "geometry/io/las/las_reader.h"
#include "geometry/io/las/layout.h"
#include "tests/support/temporary_folder.h"

namespace skycap::geometry::las {
namespace {

using testing_support::TemporaryFolder;
using Random = std::mt19937_64;

std::string read_all(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Kinds of fields of a point.
enum class Content {
  random,   ///< all bits of all fields are random
  survey,   ///< flight lines with several returns per pulse and regular times
  constant  ///< all points are equal
};

std::string random_record(std::size_t size, Random& random) {
  std::string record(size, '\0');
  for (char& byte : record) byte = static_cast<char>(random());
  // Each field is sometimes an extreme value.
  for (const std::size_t offset : {0U, 4U, 8U}) {
    const std::uint64_t choice = random() % 8;
    if (choice == 0) put_value(record.data(), offset, std::numeric_limits<std::int32_t>::min());
    if (choice == 1) put_value(record.data(), offset, std::numeric_limits<std::int32_t>::max());
  }
  const std::uint64_t choice = random() % 6;
  if (choice == 0) put_value(record.data(), point::time, std::nan(""));
  if (choice == 1) put_value(record.data(), point::time, -0.0);
  if (choice == 2) put_value(record.data(), point::time, std::numeric_limits<double>::infinity());
  return record;
}

/// Points of pulses in order, whose channels, returns, times and attributes change as in scans.
class Survey {
 public:
  Survey(std::size_t size, Random& random) : record_(size, '\0'), random_(random) {}

  const std::string& next() {
    if (left_ == 0) begin_pulse();
    const auto number = static_cast<std::uint8_t>(returns_ - --left_);
    const auto put = [&](std::size_t offset, auto value) {
      put_value(record_.data(), offset, value);
    };
    x_ += static_cast<std::int32_t>(random_() % 200) - 90;
    y_ += static_cast<std::int32_t>(random_() % 50) - 20;
    put(0, x_);
    put(4, y_);
    put(8, static_cast<std::int32_t>(100'000 - 900 * number + random_() % 300));
    put(point::intensity, static_cast<std::uint16_t>(random_() % 4000 + 10000U * number));
    put(point::returns, static_cast<std::uint8_t>(number | returns_ << 4));
    put(point::flags, static_cast<std::uint8_t>(channel_ << 4 | random_() % 50 / 49 * 0xC3));
    put(point::classification, static_cast<std::uint8_t>(random_() % 20 / 19 * 200 + number));
    put(point::user_data, static_cast<std::uint8_t>(random_() % 30 / 29));
    put(point::scan_angle, angle_);
    put(point::source, source_);
    put(point::time, time_);
    for (std::size_t i = point::colour; i < record_.size(); ++i) {
      record_[i] = static_cast<char>(record_[i] + random_() % 10 / 9);
    }
    return record_;
  }

 private:
  void begin_pulse() {
    returns_ = static_cast<std::uint8_t>(1 + random_() % 5 * (random_() % 3 / 2));
    left_ = returns_;
    time_ += random_() % 1000 == 0 ? 0.5 : 1e-6 * static_cast<double>(random_() % 3);
    if (random_() % 500 == 0) time_ += random_() % 2 == 0 ? 1e6 : -3e5;
    if (random_() % 4 == 0) channel_ = static_cast<std::uint8_t>(random_() % 4);
    angle_ = static_cast<std::int16_t>(angle_ + static_cast<int>(random_() % 5) - 2);
    if (random_() % 300 == 0) source_ = static_cast<std::uint16_t>(random_());
  }

  std::string record_;
  Random& random_;
  std::int32_t x_ = 0, y_ = 0;
  std::uint8_t returns_ = 1, left_ = 0, channel_ = 0;
  std::int16_t angle_ = 0;
  std::uint16_t source_ = 1;
  double time_ = 3.1e8;
};

std::string make_records(Content content, std::size_t size, std::size_t count) {
  Random random(count + size);
  Survey survey(size, random);
  const std::string constant = random_record(size, random);
  std::string records;
  for (std::size_t i = 0; i < count; ++i) {
    records += content == Content::random   ? random_record(size, random)
               : content == Content::survey ? survey.next()
                                            : constant;
  }
  return records;
}

WrittenFile describe(int format, std::uint16_t extra_bytes) {
  WrittenFile file;
  file.point_format = format;
  file.extra_bytes = extra_bytes;
  file.is_compressed = true;
  return file;
}

void write(const std::filesystem::path& path, const WrittenFile& file, std::string_view records,
           std::size_t piece) {
  LasFileWriter writer(path, file);
  for (std::size_t begin = 0; begin < records.size(); begin += piece) {
    writer.add(records.substr(begin, piece));
  }
  writer.finish();
}

std::string read_records(const std::filesystem::path& path) {
  LasReader reader(path, LasFields::all);
  std::string records, all;
  while (reader.next_records(records, 777)) all += records;
  return all;
}

struct Case {
  int format;
  std::uint16_t extra_bytes;
  Content content;
};

class LazWriter : public testing::TestWithParam<Case> {};

TEST_P(LazWriter, WritesPointsThatAreReadBackByteByByte) {
  const auto [format, extra_bytes, content] = GetParam();
  const TemporaryFolder folder;
  const std::size_t size = point_size(format) + std::size_t{extra_bytes};
  for (const std::size_t count : {0U, 1U, 2U, 3U, 49999U, 50000U, 50001U, 100001U}) {
    SCOPED_TRACE(count);
    const std::string records = make_records(content, size, count);
    write(folder.path() / "a.laz", describe(format, extra_bytes), records, 997 * size);
    const LasReader reader(folder.path() / "a.laz");
    EXPECT_TRUE(reader.header().is_compressed);
    EXPECT_EQ(reader.header().points, count);
    ASSERT_TRUE(read_records(folder.path() / "a.laz") == records);
  }
}

TEST_P(LazWriter, WritesSameBytesIndependentOfPieces) {
  const auto [format, extra_bytes, content] = GetParam();
  const TemporaryFolder folder;
  const std::size_t size = point_size(format) + std::size_t{extra_bytes};
  const std::string records = make_records(content, size, 50100);
  write(folder.path() / "a.laz", describe(format, extra_bytes), records, size);
  write(folder.path() / "b.laz", describe(format, extra_bytes), records, records.size());
  EXPECT_TRUE(read_all(folder.path() / "a.laz") == read_all(folder.path() / "b.laz"));
}

std::string case_name(const testing::TestParamInfo<Case>& info) {
  const auto [format, extra_bytes, content] = info.param;
  return "Format" + std::to_string(format) + "Extra" + std::to_string(extra_bytes) +
         (content == Content::random   ? "Random"
          : content == Content::survey ? "Survey"
                                       : "Constant");
}

INSTANTIATE_TEST_SUITE_P(Formats, LazWriter,
                         testing::Values(Case{6, 0, Content::random}, Case{6, 0, Content::survey},
                                         Case{6, 0, Content::constant}, Case{6, 3, Content::survey},
                                         Case{7, 0, Content::random}, Case{7, 0, Content::survey},
                                         Case{7, 5, Content::random}, Case{8, 0, Content::random},
                                         Case{8, 0, Content::survey},
                                         Case{8, 2, Content::constant}),
                         case_name);

TEST(LazWriter, CompressesSurveysToLessThanHalf) {
  const TemporaryFolder folder;
  const std::string records = make_records(Content::survey, point_size(6), 50000);
  write(folder.path() / "a.laz", describe(6, 0), records, records.size());
  EXPECT_LT(std::filesystem::file_size(folder.path() / "a.laz"), records.size() / 2);
}

TEST(LazWriter, HeaderContainsBoundsAndReturns) {
  const TemporaryFolder folder;
  std::string records;
  for (const int value : {-5, 7}) {
    std::string record(point_size(6), '\0');
    for (const std::size_t axis : {0U, 4U, 8U}) put_value(record.data(), axis, std::int32_t{value});
    record[point::returns] = static_cast<char>(value == 7 ? 0x22 : 0x21);
    records += record;
  }
  WrittenFile file = describe(6, 0);
  file.scale = {0.01, 0.1, 1.0};
  file.offset = {100.0, 200.0, 300.0};
  write(folder.path() / "a.laz", file, records, records.size());
  const std::string bytes = read_all(folder.path() / "a.laz");
  const auto number = [&](std::size_t offset) { return value_at<double>(bytes.data(), offset); };
  EXPECT_DOUBLE_EQ(number(header::bounds), 100.07);
  EXPECT_DOUBLE_EQ(number(header::bounds + 8), 99.95);
  EXPECT_DOUBLE_EQ(number(header::bounds + 16), 200.7);
  EXPECT_DOUBLE_EQ(number(header::bounds + 40), 295.0);
  EXPECT_EQ(value_at<std::uint64_t>(bytes.data(), header::points_by_return), 1U);
  EXPECT_EQ(value_at<std::uint64_t>(bytes.data(), header::points_by_return + 8), 1U);
}

// The arithmetic coder propagates a carry through any number of bytes. The most probable symbol
// has the upper end of the interval, so that long runs produce bytes of 0xFF.
TEST(ArithmeticCoder, DecodesWhatItEncodes) {
  Random random(3);
  for (int run = 0; run < 200; ++run) {
    const auto symbols = static_cast<std::uint32_t>(2 + random() % 300);
    const std::uint64_t rare = 1 + random() % 400;
    std::vector<std::uint32_t> values(random() % 5000);
    for (std::uint32_t& value : values) {
      value = random() % rare == 0 ? static_cast<std::uint32_t>(random() % symbols) : symbols - 1;
    }
    ArithmeticEncoder encoder;
    SymbolModel model(symbols);
    BitModel bit;
    for (const std::uint32_t value : values) {
      encoder.symbol(model, value);
      encoder.bit(bit, value + 1 == symbols);
      encoder.bits(1 + value % 32, value & 1);
    }
    const std::string bytes = encoder.finish();
    const ReadBytes read = [&](std::uint64_t offset, std::uint64_t count) {
      return bytes.substr(offset, count);
    };
    ArithmeticDecoder decoder(ByteWindow(read, 0, bytes.size()));
    SymbolModel decoded(symbols);
    BitModel decoded_bit;
    for (const std::uint32_t value : values) {
      ASSERT_EQ(decoder.symbol(decoded), value);
      ASSERT_EQ(decoder.bit(decoded_bit), value + 1 == symbols);
      ASSERT_EQ(decoder.bits(1 + value % 32), value & 1);
    }
  }
}

TEST(IntegerCoder, CodesAllDifferences) {
  Random random(4);
  for (const std::uint32_t bits : {8U, 16U, 32U}) {
    const std::uint32_t mask = bits == 32 ? ~0U : (1U << bits) - 1;
    std::vector<std::array<std::uint32_t, 2>> pairs;
    for (std::uint32_t bit = 0; bit < bits; ++bit) {
      for (int step = -2; step <= 2; ++step) {
        for (const std::uint32_t prediction : {0U, 1U, mask, mask / 2, 1 + mask / 2}) {
          const std::uint32_t difference = (1U << bit) + static_cast<std::uint32_t>(step);
          pairs.push_back({prediction, (prediction + difference) & mask});
          pairs.push_back({prediction, (prediction - difference) & mask});
        }
      }
    }
    ArithmeticEncoder encoder;
    IntegerCoder numbers(bits, 1), decoded(bits, 1);
    for (const auto& [prediction, value] : pairs) numbers.code(encoder, prediction, value);
    const std::string bytes = encoder.finish();
    const ReadBytes read = [&](std::uint64_t offset, std::uint64_t count) {
      return bytes.substr(offset, count);
    };
    ArithmeticDecoder decoder(ByteWindow(read, 0, bytes.size()));
    for (const auto& [prediction, value] : pairs) {
      ASSERT_EQ(decoded.read(decoder, prediction), value) << bits << " " << prediction;
    }
  }
}

/// Positions, classes and colours of files of LASzip, converted and read again.
class ConvertedLas : public testing::TestWithParam<const char*> {};

TEST_P(ConvertedLas, HasSamePointsAsOriginal) {
  const TemporaryFolder folder;
  const std::string from = std::string(LAZ_FILES) + "/" + GetParam() + ".laz";
  for (const bool is_compressed : {false, true}) {
    SCOPED_TRACE(is_compressed);
    const std::filesystem::path to = folder.path() / (is_compressed ? "a.laz" : "a.las");
    EXPECT_THAT(
        convert_las(from, to, is_compressed, Eigen::Vector3d(10.0, 20.0, 30.0), "", [](double) {}),
        testing::IsEmpty());
    LasReader old(from), now(to);
    EXPECT_EQ(now.header().minor, 4);
    EXPECT_EQ(now.header().is_compressed, is_compressed);
    EXPECT_EQ(now.header().points, old.header().points);
    LasPoints expected, found;
    while (old.next(expected)) {
      ASSERT_TRUE(now.next(found));
      ASSERT_EQ(found.positions.size(), expected.positions.size());
      for (std::size_t i = 0; i < found.positions.size(); ++i) {
        EXPECT_LT(
            (found.positions[i] - expected.positions[i] - Eigen::Vector3d(10.0, 20.0, 30.0)).norm(),
            1e-9);
      }
      EXPECT_EQ(found.classes, expected.classes);
      EXPECT_EQ(found.colours, expected.colours);
    }
  }
}

TEST_P(ConvertedLas, KeepsPointsOfFormats6To8ByteByByte) {
  const TemporaryFolder folder;
  const std::string from = std::string(LAZ_FILES) + "/" + GetParam() + ".laz";
  convert_las(from, folder.path() / "a.laz", true, Eigen::Vector3d::Zero(), "", [](double) {});
  if (LasReader(from).header().format < 6) GTEST_SKIP() << "older formats have other fields";
  EXPECT_TRUE(read_records(folder.path() / "a.laz") == read_records(from));
}

// LASzip 3.5 has written these files with chunks of several sizes.
TEST(LazWriter, WritesSameChunksAsReferenceCompressor) {
  for (const std::string name : {"format6", "format7", "format8"}) {
    SCOPED_TRACE(name);
    const std::string path = std::string(LAZ_FILES) + "/" + name + ".laz";
    const std::string bytes = read_all(path), records = read_records(path);
    const LasHeader header = LasReader(path).header();
    const std::size_t begin = header.first_point + 8;
    const auto end = value_at<std::uint64_t>(bytes.data(), header.first_point);
    std::ifstream stream(path, std::ios::binary);
    const auto encoder = make_chunk_encoder(header.format, header.point_size);
    std::string chunks;
    std::size_t point = 0;
    for (const WrittenChunk& chunk :
         find_chunks(stream, begin, end, header.format, header.point_size)) {
      for (std::uint32_t i = 0; i < chunk.points; ++i) {
        encoder->add(records.data() + header.point_size * point++);
      }
      chunks += encoder->finish();
    }
    EXPECT_EQ(point, header.points);
    EXPECT_TRUE(chunks == bytes.substr(begin, end - begin));
  }
}

INSTANTIATE_TEST_SUITE_P(Files, ConvertedLas,
                         testing::Values("format0", "format1", "format2", "format3", "format6",
                                         "format7", "format8", "various_chunks"),
                         [](const auto& file) { return std::string(file.param); });

// Fields of format 3 in format 7, by the layouts of the ASPRS specification R15.
TEST(PointUpgrade, MovesFieldsOfOldFormats) {
  LasHeader header;
  header.format = 3;
  header.point_size = point_size(3) + 2UL;
  std::string old(header.point_size, '\0');
  put_value(old.data(), 0, std::array<std::int32_t, 3>{1, -2, 3});
  put_value(old.data(), 12, std::uint16_t{500});
  old[14] = static_cast<char>(2 | 3 << 3 | 1 << 6 | 1 << 7);  // return 2 of 3, direction, edge
  old[15] = static_cast<char>(6 | 1 << 5 | 1 << 7);           // building, synthetic, withheld
  old[16] = static_cast<char>(-30);                           // degrees
  old[17] = 9;
  put_value(old.data(), 18, std::uint16_t{77});
  put_value(old.data(), 20, 123.5);
  put_value(old.data(), 28, std::array<std::uint16_t, 3>{10, 20, 30});
  old[34] = 'e';
  old[35] = 'x';
  const PointUpgrade upgrade(header);
  ASSERT_EQ(upgrade.format(), 7);
  ASSERT_EQ(upgrade.extra_bytes(), 2);
  std::string now;
  upgrade.convert(old, now);
  ASSERT_EQ(now.size(), 38U);
  EXPECT_EQ(now.substr(0, 14), old.substr(0, 14));
  EXPECT_EQ(now[14], 2 | 3 << 4);
  EXPECT_EQ(static_cast<std::uint8_t>(now[15]), 1 | 4 | 1 << 6 | 1 << 7);
  EXPECT_EQ(now[16], 6);
  EXPECT_EQ(now[17], 9);
  EXPECT_EQ(value_at<std::int16_t>(now.data(), 18), -5000);
  EXPECT_EQ(value_at<std::uint16_t>(now.data(), 20), 77);
  EXPECT_EQ(value_at<double>(now.data(), 22), 123.5);
  EXPECT_EQ(now.substr(30, 6), old.substr(28, 6));
  EXPECT_EQ(now.substr(36), "ex");
}

}  // namespace
}  // namespace skycap::geometry::las
