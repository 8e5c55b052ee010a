#include "flight/calibration/flight_log.h"

#include <cstdint>
#include <cstring>
#include <functional>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

using testing::HasSubstr;
using testing::SizeIs;
using testing::ThrowsMessage;

/// Writes a DataFlash log according to the format description of AP_Logger.
class DataflashWriter {
 public:
  void format(std::uint8_t type, std::uint8_t size, const std::string& name,
              const std::string& letters, const std::string& labels) {
    begin(128);
    put(type), put(size);
    text(name, 4), text(letters, 16), text(labels, 64);
  }
  void begin(std::uint8_t type) { bytes += {'\xA3', '\x95', static_cast<char>(type)}; }
  template <typename T>
  void put(T value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  }
  void text(std::string what, std::size_t size) {
    what.resize(size, '\0');
    bytes += what;
  }

  std::string bytes;
};

std::string sample_log() {
  DataflashWriter log;
  log.format(10, 26, "XKF1", "QBfffc", "TimeUS,C,VN,VE,VD,X");
  log.format(11, 20, "BAT", "QBff", "TimeUS,Inst,Volt,Curr");
  log.format(12, 31, "PARM", "QNf", "TimeUS,Name,Value");
  log.format(13, 33, "CMD", "QHffLLf", "TimeUS,CId,Prm1,Prm2,Lat,Lng,Alt");
  const auto state = [&](std::uint8_t core, float north) {
    log.begin(10);
    log.put<std::uint64_t>(1), log.put(core), log.put(north), log.put(2.0F), log.put(-0.5F);
    log.put<std::int16_t>(7);
  };
  const auto battery = [&](std::uint64_t time, std::uint8_t which, float amperes) {
    log.begin(11);
    log.put(time), log.put(which), log.put(20.0F), log.put(amperes);
  };
  battery(500'000, 0, 3.0F);  // before the first estimator state
  state(0, 1.0F), state(1, 9.0F);
  battery(1'000'000, 0, 10.0F);
  battery(1'100'000, 1, 5.0F);
  log.begin(12), log.put<std::uint64_t>(2), log.text("WP_JERK", 16), log.put(1.5F);
  log.begin(13), log.put<std::uint64_t>(3'000'000), log.put<std::uint16_t>(16), log.put(2.0F);
  log.put(0.0F), log.put<std::int32_t>(517534580), log.put<std::int32_t>(-12540220);
  log.put(30.5F);
  return log.bytes;
}

TEST(DataflashLog, ReadsPowerVelocityParametersAndCommands) {
  const FlightLog log = read_dataflash(sample_log());
  ASSERT_THAT(log.samples, SizeIs(2));
  EXPECT_DOUBLE_EQ(log.samples[0].time, 1.0);
  EXPECT_DOUBLE_EQ(log.samples[0].power, 200.0);
  EXPECT_EQ(log.samples[0].velocity, Eigen::Vector3d(2.0, 1.0, 0.5));
  EXPECT_DOUBLE_EQ(log.samples[1].power, 300.0);  // sum of both batteries
  ASSERT_THAT(log.parameters, SizeIs(1));
  EXPECT_EQ(log.parameters[0].name, "WP_JERK");
  EXPECT_EQ(log.parameters[0].value, 1.5);
  ASSERT_THAT(log.commands, SizeIs(1));
  EXPECT_EQ(log.commands[0].command, 16);
  EXPECT_NEAR(log.commands[0].latitude_deg, 51.753458, 1e-9);
  EXPECT_NEAR(log.commands[0].longitude_deg, -1.254022, 1e-9);
  EXPECT_DOUBLE_EQ(log.commands[0].height, 30.5);
}

/// The log contains two samples, one parameter and one command.
TEST(DataflashLog, RejectsMoreEntriesThanTheLimit) {
  EXPECT_THAT(read_dataflash(sample_log(), 4).samples, SizeIs(2));
  EXPECT_THAT(
      [] { read_dataflash(sample_log(), 3); },
      ThrowsMessage<Error>(HasSubstr("contains more than 3 samples, parameters and commands")));
}

TEST(DataflashLog, SkipsDamagedBytes) {
  const std::string good = sample_log();
  const std::string log = good.substr(0, 4 * 89) + "\xA3\x95\x77garbage\xA3" + good.substr(4 * 89);
  EXPECT_THAT(read_dataflash(log).samples, SizeIs(2));
  EXPECT_THAT(read_dataflash(good.substr(0, good.size() - 3)).samples, SizeIs(2));
}

// Property: random bytes yield a result or an Error.
TEST(DataflashLog, ReadsOrRejectsRandomlyCorruptedLogs) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 2000; ++i) {
    std::string log = sample_log();
    for (int k = 0; k < 4; ++k) log[random() % log.size()] = static_cast<char>(random());
    try {
      read_dataflash(log);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_file);
    }
  }
}

TEST(DataflashLog, ReportsMissingMessages) {
  const auto throws_message = [](const char* what) {
    return ThrowsMessage<Error>(HasSubstr(what));
  };
  EXPECT_THAT([] { read_dataflash("no log"); }, throws_message("dataflash log"));
  EXPECT_THAT([] { read_dataflash(sample_log().substr(0, 4 * 89)); },
              throws_message("contains no velocity"));
  EXPECT_THAT([] { read_dataflash(sample_log().substr(0, 4 * 89 + 46)); },
              throws_message("contains no battery"));
}

TEST(CsvLog, AcceptsColumnsInAnyOrder) {
  const FlightLog log = read_csv_log(
      "power_w,time_s,volts,up_m_s,east_m_s,north_m_s\n200,1,22,0.5,2,1\n210,1.1,22,0,3,4\n");
  ASSERT_THAT(log.samples, SizeIs(2));
  EXPECT_EQ(log.samples[0].power, 200.0);
  EXPECT_EQ(log.samples[0].velocity, Eigen::Vector3d(2, 1, 0.5));
}

TEST(CsvLog, ReportsErrorsWithLineNumber) {
  const std::string header = "time_s,east_m_s,north_m_s,up_m_s,power_w\n";
  const auto rejects = [&](const std::string& text, const char* what) {
    EXPECT_THAT([&] { read_csv_log(text); }, ThrowsMessage<Error>(HasSubstr(what))) << text;
  };
  rejects("time_s,power_w\n", "line 1 has no column east_m_s");
  rejects(header + "1,0,0,0,x\n", "line 2 has \"x\" for power_w; it must be a number");
  rejects(header + "1,0,0\n", "line 2 has too few fields");
  rejects(header + "1,0,0,0,9\n1,0,0,0,9\n",
          "line 3 has a time that is not later than that of the previous line");
  rejects(header, "must be followed by at least one sample");
}

TEST(CsvLog, RejectsMoreSamplesThanTheLimit) {
  const std::string two = "time_s,east_m_s,north_m_s,up_m_s,power_w\n1,0,0,0,9\n2,0,0,0,9\n";
  EXPECT_THAT(read_csv_log(two, 2).samples, SizeIs(2));
  EXPECT_THAT([&] { read_csv_log(two, 1); },
              ThrowsMessage<Error>(HasSubstr("line 3 exceeds the limit of 1 samples")));
}

}  // namespace
}  // namespace skycap::flight
