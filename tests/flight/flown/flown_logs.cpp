#include "tests/flight/flown/flown_logs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "geometry/angle.h"
#include "tests/flight/calibration/dataflash_writer.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Time between the start of the autopilot and the first state [s].
constexpr double start_time = 12.5;

double undulation(const Site& site) { return site.geoid_undulation.value_or(0.0); }

class UlogWriter {
 public:
  UlogWriter() {
    bytes_ = std::string("ULog\x01\x12\x35\x01", 8);
    put(bytes_, std::uint64_t{12'500'000});
    add('B', std::string(40, '\0'));
  }
  void describe(const std::string& format) { add('F', format); }
  void subscribe(std::uint16_t number, const std::string& topic) {
    std::string body(1, '\0');
    put(body, number);
    add('A', body + topic);
  }
  void data(std::uint16_t number, const std::string& fields) {
    std::string body;
    put(body, number);
    add('D', body + fields);
  }
  void synchronise() { add('S', "\x2F\x73\x13\x20\x25\x0C\xBB\x12"); }
  const std::string& bytes() const { return bytes_; }

  template <class T>
  static void put(std::string& bytes, T value) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), &value, sizeof value);
    bytes.append(raw.data(), raw.size());
  }

 private:
  void add(char type, const std::string& body) {
    put(bytes_, static_cast<std::uint16_t>(body.size()));
    bytes_ += type;
    bytes_ += body;
  }
  std::string bytes_;
};

template <class... T>
std::string fields(T... values) {
  std::string bytes;
  (UlogWriter::put(bytes, values), ...);
  return bytes;
}

/// Returns w, x, y, z of a rotation by yaw, then pitch.
std::string quaternion(double yaw_deg, double pitch_deg) {
  const double y = 0.5 * yaw_deg * geometry::radians_per_degree;
  const double p = 0.5 * pitch_deg * geometry::radians_per_degree;
  return fields(
      static_cast<float>(std::cos(y) * std::cos(p)), static_cast<float>(-std::sin(y) * std::sin(p)),
      static_cast<float>(std::cos(y) * std::sin(p)), static_cast<float>(std::sin(y) * std::cos(p)));
}

/// Returns a log of Copter 3.2: TimeMS of GPS is the time of the week, and T the autopilot's.
std::string write_dataflash_of_2014(const std::vector<FlownState>& flight, const Site& site,
                                    double pad_height) {
  const LogFormat receiver{11, "GPS", "BIHBcLLeeEefI",
                           "Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T"};
  const LogFormat attitude{12, "ATT", "IccccCC", "TimeMS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw"};
  constexpr double time_of_week = 421'400'000.0;
  DataflashWriter writer;
  for (const LogFormat& format : {receiver, attitude}) writer.describe(format);
  const LocalFrame frame(site.origin);
  for (const FlownState& flown : flight) {
    const double time = std::round(1e3 * (start_time + flown.state.time));
    const GeodeticPoint point = frame.to_geodetic(flown.state.position);
    writer.add(attitude,
               {{"TimeMS", time}, {"Yaw", std::fmod(flown.state.yaw_deg + 360.0, 360.0)}});
    writer.add(receiver, {{"Status", 3.0},
                          {"TimeMS", time_of_week + time},
                          {"Lat", point.latitude_deg},
                          {"Lng", point.longitude_deg},
                          {"RelAlt", point.height - pad_height},
                          {"Alt", point.height - undulation(site)},
                          {"T", time}});
  }
  return writer.bytes();
}

}  // namespace

std::vector<FlownState> fly_polyline(const std::vector<Vector3d>& points,
                                     const std::vector<std::size_t>& captures, double speed,
                                     double rest) {
  constexpr double interval = 0.1, yaw_deg = 0.0, pitch_deg = -20.0;
  std::vector<FlownState> flight;
  const auto add = [&](const Vector3d& position, bool is_capture) {
    const double time = interval * static_cast<double>(flight.size());
    flight.push_back({{time, position, yaw_deg, yaw_deg, pitch_deg}, is_capture});
  };
  const auto stay = [&](const Vector3d& position, bool is_capture) {
    const int count = static_cast<int>(rest / interval);
    for (int k = 0; k < count; ++k) add(position, is_capture && k == count / 2);
  };
  stay(points.front(), false);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector3d displacement = points[i] - points[i - 1];
    const int count = static_cast<int>(std::ceil(displacement.norm() / (speed * interval)));
    for (int k = 1; k <= count; ++k) add(points[i - 1] + displacement * k / count, false);
    const bool is_capture = std::ranges::find(captures, i) != captures.end();
    if (is_capture || i + 1 == points.size()) stay(points[i], is_capture);
  }
  return flight;
}

std::string write_dataflash(const std::vector<FlownState>& flight, const Site& site,
                            const Vector3d& pad, DataflashLayout layout) {
  const LocalFrame frame(site.origin);
  const double pad_height = frame.to_geodetic(pad).height;
  if (layout == DataflashLayout::copter_3_2_of_2014) {
    return write_dataflash_of_2014(flight, site, pad_height);
  }
  const bool is_old = layout == DataflashLayout::copter_3_6_of_2019;
  const LogFormat position{11, "POS", "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt"};
  const LogFormat attitude =
      is_old ? LogFormat{12, "ATT", "QccccCCCC",
                         "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw"}
             : LogFormat{12, "ATT", "QccccCCCCB",
                         "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw,AEKF"};
  const LogFormat camera =
      is_old ? LogFormat{13, "CAM", "QIHLLeeeccC",
                         "TimeUS,GPSTime,GPSWeek,Lat,Lng,Alt,RelAlt,GPSAlt,Roll,Pitch,Yaw"}
             : LogFormat{13, "CAM", "QBHIHLLffffff",
                         "TimeUS,I,Img,GPSTime,GPSWeek,Lat,Lng,Alt,RelAlt,GPSAlt,R,P,Y"};
  const LogFormat mount{14, "MNT", "QBffffffff",
                        "TimeUS,I,DesRoll,Roll,DesPitch,Pitch,DesYawB,YawB,DesYawE,YawE"};
  const bool has_mount = layout == DataflashLayout::copter_4_6_of_2025;
  DataflashWriter writer;
  for (const LogFormat& format : {position, attitude, camera}) writer.describe(format);
  if (has_mount) writer.describe(mount);
  for (const FlownState& flown : flight) {
    const double time = std::round(1e6 * (start_time + flown.state.time));
    const GeodeticPoint point = frame.to_geodetic(flown.state.position);
    const double height = point.height - undulation(site), above = point.height - pad_height;
    const double yaw = std::fmod(flown.state.yaw_deg + 360.0, 360.0);
    writer.add(attitude, {{"TimeUS", time}, {"Yaw", yaw}});
    if (has_mount) {
      writer.add(mount, {{"TimeUS", time},
                         {"Pitch", flown.state.camera_pitch_deg},
                         {"YawE", flown.state.camera_yaw_deg}});
    }
    writer.add(position, {{"TimeUS", time},
                          {"Lat", point.latitude_deg},
                          {"Lng", point.longitude_deg},
                          {"Alt", height},
                          {"RelHomeAlt", above}});
    if (!flown.is_capture) continue;
    writer.add(camera, {{"TimeUS", time},
                        {"Lat", point.latitude_deg},
                        {"Lng", point.longitude_deg},
                        {"Alt", height},
                        {"RelAlt", above},
                        {is_old ? "Yaw" : "Y", yaw}});
  }
  return writer.bytes();
}

std::string write_ulog(const std::vector<FlownState>& flight, const Site& site, const Vector3d& pad,
                       UlogLayout layout) {
  const bool is_old = layout == UlogLayout::px4_1_9_of_2019;
  constexpr std::uint16_t position = 0, attitude = 1, home = 2, capture = 3, gimbal = 4;
  UlogWriter writer;
  writer.describe(is_old ? "vehicle_global_position:uint64_t timestamp;double lat;double lon;float "
                           "alt;float[2] delta;uint8_t[4] _padding0;"
                         : "vehicle_global_position:uint64_t timestamp;uint64_t timestamp_sample;"
                           "double lat;double lon;float alt;bool lat_lon_valid;");
  writer.describe("vehicle_attitude:uint64_t timestamp;float[4] q;");
  writer.describe("home_position:uint64_t timestamp;double lat;double lon;float alt;");
  writer.describe(
      "camera_capture:uint64_t timestamp;uint64_t timestamp_utc;double lat;double lon;float "
      "alt;float ground_distance;float[4] q;uint32_t seq;int8_t result;");
  writer.describe(
      "gimbal_device_attitude_status:uint64_t timestamp;float[4] q;uint16_t device_flags;");
  writer.subscribe(position, "vehicle_global_position");
  writer.subscribe(attitude, "vehicle_attitude");
  writer.subscribe(home, "home_position");
  writer.subscribe(capture, "camera_capture");
  if (!is_old) writer.subscribe(gimbal, "gimbal_device_attitude_status");
  const LocalFrame frame(site.origin);
  const GeodeticPoint pad_point = frame.to_geodetic(pad);
  writer.data(home,
              fields(std::uint64_t{12'500'000}, pad_point.latitude_deg, pad_point.longitude_deg,
                     static_cast<float>(pad_point.height - undulation(site))));
  std::uint32_t sequence = 0, count = 0;
  for (const FlownState& flown : flight) {
    if (count++ % 20 == 0) writer.synchronise();
    const auto time =
        static_cast<std::uint64_t>(std::llround(1e6 * (start_time + flown.state.time)));
    const GeodeticPoint point = frame.to_geodetic(flown.state.position);
    const auto height = static_cast<float>(point.height - undulation(site));
    writer.data(attitude, fields(time) + quaternion(flown.state.yaw_deg, 0.0));
    if (!is_old) {
      constexpr std::uint16_t yaw_lock = 16;
      writer.data(gimbal, fields(time) +
                              quaternion(flown.state.camera_yaw_deg, flown.state.camera_pitch_deg) +
                              fields(yaw_lock));
    }
    writer.data(position,
                is_old ? fields(time, point.latitude_deg, point.longitude_deg, height, 0.0F, 0.0F)
                       : fields(time, time, point.latitude_deg, point.longitude_deg, height,
                                std::uint8_t{1}));
    if (!flown.is_capture) continue;
    writer.data(capture, fields(time, time, point.latitude_deg, point.longitude_deg, height, 0.0F) +
                             quaternion(flown.state.yaw_deg, 0.0) +
                             fields(sequence++, std::int8_t{1}));
  }
  return writer.bytes();
}

}  // namespace skycap::flight
