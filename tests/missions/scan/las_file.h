/// Reader for LAS files that follows the specification strictly. A test fails if its file deviates
/// from it.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace skycap::missions {

inline std::vector<char> read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

template <typename Value>
Value value_at(const std::vector<char>& bytes, std::size_t offset) {
  Value value;
  EXPECT_LE(offset + sizeof value, bytes.size());
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

struct LasPoint {
  Eigen::Vector3d position;
  int intensity, return_number, returns, channel;
  double angle_deg, time;
};

/// Strict reader for LAS 1.4 R15: header and point formats 6 and 7.
struct LasFile {
  std::vector<LasPoint> points;
  std::string crs;

  explicit LasFile(const std::filesystem::path& path, int point_format = 6) {
    const std::vector<char> bytes = read_bytes(path);
    EXPECT_EQ(std::string(bytes.data(), 4), "LASF");
    EXPECT_EQ(value_at<std::uint16_t>(bytes, 6), 0b10001);  // WKT, adjusted GPS time
    EXPECT_EQ(bytes[24], 1);
    EXPECT_EQ(bytes[25], 4);
    EXPECT_EQ(value_at<std::uint16_t>(bytes, 94), 375);
    const auto first_point = value_at<std::uint32_t>(bytes, 96);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, 100), 1U);
    EXPECT_EQ(bytes[104], point_format);
    const std::size_t size = point_format == 7 ? 36 : 30;
    EXPECT_EQ(value_at<std::uint16_t>(bytes, 105), size);
    for (std::size_t offset = 107; offset < 131; offset += 4) {
      EXPECT_EQ(value_at<std::uint32_t>(bytes, offset), 0U);
    }
    const auto count = value_at<std::uint64_t>(bytes, 247);
    EXPECT_EQ(bytes.size(), first_point + size * count);

    EXPECT_EQ(std::string(bytes.data() + 377), "LASF_Projection");
    EXPECT_EQ(value_at<std::uint16_t>(bytes, 393), 2112);
    const auto crs_size = value_at<std::uint16_t>(bytes, 395);
    EXPECT_EQ(first_point, 375U + 54 + crs_size);
    crs = std::string(bytes.data() + 429);
    EXPECT_EQ(crs.size() + 1, crs_size);

    Eigen::AlignedBox3d bounds;
    std::array<std::uint64_t, 15> by_return = {};
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::size_t at = first_point + size * i;
      LasPoint point;
      for (int axis = 0; axis < 3; ++axis) {
        point.position[axis] =
            value_at<std::int32_t>(bytes, at + 4 * axis) * value_at<double>(bytes, 131 + 8 * axis) +
            value_at<double>(bytes, 155 + 8 * axis);
      }
      point.intensity = value_at<std::uint16_t>(bytes, at + 12);
      point.return_number = bytes[at + 14] & 15;
      point.returns = (bytes[at + 14] >> 4) & 15;
      point.channel = static_cast<std::uint8_t>(bytes[at + 17]);
      point.angle_deg = 0.006 * value_at<std::int16_t>(bytes, at + 18);
      point.time = value_at<double>(bytes, at + 22);
      for (std::size_t colour = 30; colour < size; colour += 2) {
        EXPECT_EQ(value_at<std::uint16_t>(bytes, at + colour), point.intensity);
      }
      points.push_back(point);
      bounds.extend(point.position);
      ++by_return[point.return_number - 1];
    }
    for (int i = 0; i < 15; ++i) {
      EXPECT_EQ(value_at<std::uint64_t>(bytes, 255 + 8 * i), by_return[i]) << i;
    }
    if (count == 0) return;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(value_at<double>(bytes, 179 + 16 * axis), bounds.max()[axis], 1e-9);
      EXPECT_NEAR(value_at<double>(bytes, 187 + 16 * axis), bounds.min()[axis], 1e-9);
    }
  }
};

}  // namespace skycap::missions
