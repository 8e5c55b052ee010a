// Compares Skycap's IDL with the message definitions of ROS 2. The serialisation by DDS is compared
// with bytes that this test writes field by field, in the order and with the types of the .msg
// files. The encoding is plain CDR, little-endian: each number is aligned to its size, counted from
// the end of the four-byte header.

#include <chrono>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "clients/ros2/dds_ports.h"
#include "tests/clients/ros2/dds_domain.h"
#include "tests/clients/ros2/sample_messages.h"

namespace skycap::ros2 {
namespace {

/// Serialises values according to the CDR alignment rules.
class Cdr {
 public:
  template <typename Number>
  Cdr& number(Number value) {
    while (bytes_.size() % sizeof value != 0) bytes_.push_back('\0');
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Cdr& string(const std::string& text) {  // length including the terminating null
    number(static_cast<std::uint32_t>(text.size() + 1));
    bytes_ += text + '\0';
    return *this;
  }
  Cdr& doubles(int count, double first) {
    for (int i = 0; i < count; ++i) number(first + i);
    return *this;
  }
  Cdr& header(std::int32_t sec, std::uint32_t nanosec, const std::string& frame) {
    return number(sec).number(nanosec).string(frame);
  }
  /// Returns the bytes with the encapsulation header (CDR_LE) and the number of padding bytes.
  std::string whole() const {
    const std::size_t padding = (4 - bytes_.size() % 4) % 4;
    return std::string{'\0', '\1', '\0', static_cast<char>(padding)} + bytes_ +
           std::string(padding, '\0');
  }

 private:
  std::string bytes_;
};

/// Returns the bytes that DDS sends for a message. Empty if nothing arrives within 10 s.
template <typename Message>
std::string sent(const Message& message) {
  const Participant participant(own_domain());
  const std::string topic = topics() + "/wire";
  const Writer<Message> writer(participant, topic, Writing::latched);
  const Reader<Message> reader(participant, topic, ReaderQos::latched, 1);
  writer.write(message);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    ddsi_serdata* data = nullptr;
    dds_sample_info_t info;
    if (dds_takecdr(reader.handle(), &data, 1, &info, DDS_ANY_STATE) == 1) {
      std::string bytes(ddsi_serdata_size(data), '\0');
      ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
      ddsi_serdata_unref(data);
      return bytes;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return {};
}

template <std::size_t size>
void count_up(double (&numbers)[size], double first) {
  for (std::size_t i = 0; i < size; ++i) numbers[i] = first + static_cast<double>(i);
}

/// Header stamp: int32 sec, uint32 nanosec; string frame_id. Uint32 height, width; PointField[]
/// fields: string name, uint32 offset, uint8 datatype, uint32 count; bool is_bigendian; uint32
/// point_step, row_step; uint8[] data; bool is_dense.
TEST(Wire, SerializesPointCloud2) {
  SampleCloud cloud(seconds(7.5), {{1, 2, 3}});
  cloud.message.is_dense = true;
  Cdr expected;
  expected.header(7, 500'000'000, "camera_optical").number(1U).number(1U).number(3U);
  for (std::uint32_t i = 0; i < 3; ++i) {
    expected.string(std::string(1, static_cast<char>('x' + i))).number(4 * i);
    expected.number(std::uint8_t{7}).number(1U);
  }
  expected.number(std::uint8_t{0}).number(16U).number(16U).number(16U);
  expected.number(1.0F).number(2.0F).number(3.0F).number(0U).number(std::uint8_t{1});
  EXPECT_EQ(sent(cloud.message), expected.whole());
}

/// Header, uint32 height, width, string encoding, uint8 is_bigendian, uint32 step, uint8[] data.
TEST(Wire, SerializesImage) {
  const SampleImage image(seconds(7.5), 3, std::vector<std::uint16_t>{1, 2, 3}, "16UC1");
  Cdr expected;
  expected.header(7, 500'000'000, "camera_optical").number(1U).number(3U).string("16UC1");
  expected.number(std::uint8_t{0}).number(6U).number(6U);
  for (const int pixel : {1, 2, 3}) expected.number(static_cast<std::uint16_t>(pixel));
  EXPECT_EQ(sent(image.message), expected.whole());
}

/// Header, uint32 height, width, string distortion_model, float64[] d, float64[9] k, float64[9] r,
/// float64[12] p, uint32 binning_x, binning_y, RegionOfInterest: uint32 x_offset, y_offset, height,
/// width, bool do_rectify.
TEST(Wire, SerializesCameraInfo) {
  SampleInfo info({0.5});
  count_up(info.message.k, 10);
  count_up(info.message.r, 20);
  count_up(info.message.p, 30);
  info.message.binning_x = 51;
  info.message.binning_y = 52;
  info.message.roi = {53, 54, 55, 56, true};
  Cdr expected;
  expected.header(1, 0, "camera_optical").number(2U).number(4U).string("plumb_bob");
  expected.number(1U).number(0.5).doubles(9, 10).doubles(9, 20).doubles(12, 30);
  for (std::uint32_t value = 51; value <= 56; ++value) expected.number(value);
  expected.number(std::uint8_t{1});
  EXPECT_EQ(sent(info.message), expected.whole());
}

/// Header, string child_frame_id, PoseWithCovariance: Point x y z, Quaternion x y z w, float64[36];
/// TwistWithCovariance: Vector3 linear, angular, float64[36].
TEST(Wire, SerializesOdometry) {
  SampleOdometry odometry(seconds(7.5), {1, 2, 3}, Eigen::Quaterniond(7, 4, 5, 6));
  count_up(odometry.message.pose.covariance, 100);
  odometry.message.twist.twist = {{11, 12, 13}, {14, 15, 16}};
  count_up(odometry.message.twist.covariance, 200);
  Cdr expected;
  expected.header(7, 500'000'000, "odom").string("base_link").doubles(7, 1).doubles(36, 100);
  expected.doubles(6, 11).doubles(36, 200);
  EXPECT_EQ(sent(odometry.message), expected.whole());
}

/// Pose: Header, Pose. Path: Header, PoseStamped[].
TEST(Wire, SerializesPosesAndPaths) {
  std::string frame = "map";
  std::vector<PoseStamped> poses(2);
  poses[0] = {make_header(seconds(7.5), frame), {{1, 2, 3}, {4, 5, 6, 7}}};
  poses[1] = {make_header(seconds(8.0), frame), {{8, 9, 10}, {11, 12, 13, 14}}};
  Cdr one, two;
  one.header(7, 500'000'000, "map").doubles(7, 1);
  EXPECT_EQ(sent(poses[0]), one.whole());
  two.header(9, 0, "map").number(2U).header(7, 500'000'000, "map").doubles(7, 1);
  two.header(8, 0, "map").doubles(7, 8);
  EXPECT_EQ(sent(Path{make_header(seconds(9.0), frame), {2, 2, poses.data(), false}}), two.whole());
}

/// TransformStamped[]: Header, string child_frame_id, Transform: Vector3 translation, Quaternion
/// rotation x y z w.
TEST(Wire, SerializesTransforms) {
  const SampleTransforms sample(seconds(7.5), {{"base_link", "mast", {1, 2, 3}, {7, 4, 5, 6}},
                                               {"mast", "camera", {8, 9, 10}, {14, 11, 12, 13}}});
  Cdr expected;
  expected.number(2U).header(7, 500'000'000, "base_link").string("mast").doubles(7, 1);
  expected.header(7, 500'000'000, "mast").string("camera").doubles(7, 8);
  EXPECT_EQ(sent(sample.message), expected.whole());
}

TEST(Wire, SerializesString) {
  std::string text = "take";
  EXPECT_EQ(sent(String{text.data()}), Cdr().string("take").whole());
}

/// DDS matches topics by type name. ROS 2 builds the type name from package, folder and message.
TEST(Wire, UsesRos2TypeNames) {
  EXPECT_STREQ(descriptor<PointCloud2>().m_typename, "sensor_msgs::msg::dds_::PointCloud2_");
  EXPECT_STREQ(descriptor<Image>().m_typename, "sensor_msgs::msg::dds_::Image_");
  EXPECT_STREQ(descriptor<CameraInfo>().m_typename, "sensor_msgs::msg::dds_::CameraInfo_");
  EXPECT_STREQ(descriptor<Odometry>().m_typename, "nav_msgs::msg::dds_::Odometry_");
  EXPECT_STREQ(descriptor<Path>().m_typename, "nav_msgs::msg::dds_::Path_");
  EXPECT_STREQ(descriptor<PoseStamped>().m_typename, "geometry_msgs::msg::dds_::PoseStamped_");
  EXPECT_STREQ(descriptor<TFMessage>().m_typename, "tf2_msgs::msg::dds_::TFMessage_");
  EXPECT_STREQ(descriptor<String>().m_typename, "std_msgs::msg::dds_::String_");
}

}  // namespace
}  // namespace skycap::ros2
