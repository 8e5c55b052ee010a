// ArduPilot log layouts from 2014 to 2026, intact and damaged. The fitted power equals the true
// power, or the log is rejected.
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/calibration/calibration.h"
#include "flight/calibration/flight_log.h"
#include "flight/export/geodesy.h"
#include "flight/motion/hover_power.h"
#include "flight/motion/motion.h"
#include "tests/flight/calibration/dataflash_writer.h"
#include "tests/flight/vehicles.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing_support::thrown_message;

/// Definitions of the messages that calibration reads, in one firmware version.
struct Layout {
  const char* name;
  LogFormat battery, estimator, parameter, item;
};

const LogFormat old_items{13, "CMD", "QHHHfffffff",
                          "TimeUS,CTot,CNum,CId,Prm1,Prm2,Prm3,Prm4,Lat,Lng,Alt"};
const LogFormat items{13, "CMD", "QHHHffffLLfB",
                      "TimeUS,CTot,CNum,CId,Prm1,Prm2,Prm3,Prm4,Lat,Lng,Alt,Frame"};
const LogFormat executed{14, "MISE", items.letters, items.labels};

const std::vector<Layout>& layouts() {
  static const std::vector<Layout> all = {
      {"copter_3_2_of_2014",
       {11, "CURR", "IhIhhhf", "TimeMS,ThrOut,ThrInt,Volt,Curr,Vcc,CurrTot"},
       {10, "EKF1", "IccCfff", "TimeMS,Roll,Pitch,Yaw,VN,VE,VD"},
       {12, "PARM", "Nf", "Name,Value"},
       old_items},
      {"copter_3_6_of_2019",
       {11, "BAT", "Qfffffcf", "TimeUS,Volt,VoltR,Curr,CurrTot,EnrgTot,Temp,Res"},
       {10, "NKF1", "QccCfffffffccce", "TimeUS,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH"},
       {12, "PARM", "QNf", "TimeUS,Name,Value"},
       old_items},
      {"copter_4_0_of_2020",
       {11, "BAT", "QBfffffcf", "TimeUS,Instance,Volt,VoltR,Curr,CurrTot,EnrgTot,Temp,Res"},
       {10, "NKF1", "QBccCfffffffccce",
        "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH"},
       {12, "PARM", "QNf", "TimeUS,Name,Value"},
       items},
      {"copter_4_3_of_2022",
       {11, "BAT", "QBfffffcfB", "TimeUS,Inst,Volt,VoltR,Curr,CurrTot,EnrgTot,Temp,Res,RemPct"},
       {10, "XKF1", "QBccCfffffffccce",
        "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH"},
       {12, "PARM", "QNff", "TimeUS,Name,Value,Default"},
       items},
      {"copter_4_7_of_2026",
       {11, "BAT", "QBfffffcfBBB",
        "TimeUS,Inst,Volt,VoltR,Curr,CurrTot,EnrgTot,Temp,Res,RemPct,H,SH"},
       {10, "XKF1", "QBccCfffffffccce",
        "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH"},
       {12, "PARM", "QNff", "TimeUS,Name,Value,Default"},
       executed}};
  return all;
}

/// Returns the vehicle that flies in the log and hovers at this power [W].
Vehicle reference_vehicle(double hover_power) {
  Vehicle vehicle = vehicle_profile("generic_ardupilot");
  vehicle.avionics_power = 0.1 * hover_power;
  vehicle.endurance_min = endurance_at(vehicle, hover_power);
  vehicle.drag_area = 0.06;
  return vehicle;
}

/// Returns the velocity of the test flight: hover, two rounds of level legs in four directions at
/// two speeds, and a climb.
Vector3d velocity_at(double time) {
  if (time < 60.0) return Vector3d::Zero();
  if (time > 320.0) return {0, 0, 2.0};
  const auto leg = static_cast<int>((time - 60.0) / 20.0);
  const double speed = leg % 2 == 0 ? 4.0 : 8.0, direction = 0.5 * M_PI * (leg / 2 % 4);
  return {speed * std::sin(direction), speed * std::cos(direction), 0.0};
}

constexpr double duration = 340.0;

double time_factor(const LogFormat& format) {
  return format.labels.starts_with("TimeMS") ? 1e3 : 1e6;
}

/// Returns a log with ten samples per second. `measure_amperes` modifies the current reading.
template <class Amperes>
std::string make_log(const Layout& layout, const Vehicle& vehicle, const Amperes& measure_amperes) {
  const Motion motion(vehicle, {.wind = {1.0, -2.0}});
  DataflashWriter log;
  for (const LogFormat* format :
       {&layout.estimator, &layout.battery, &layout.parameter, &layout.item}) {
    log.describe(*format);
  }
  log.add(layout.parameter, {{"Value", 300.0}}, "WPNAV_SPEED_UP");
  const bool is_old = layout.battery.name == "CURR";
  constexpr double volts = 22.0;
  for (int i = 0; i < 10 * static_cast<int>(duration); ++i) {
    const double time = 0.1 * i;
    const Vector3d velocity = velocity_at(time);
    log.add(layout.estimator, {{time_factor(layout.estimator) == 1e3 ? "TimeMS" : "TimeUS",
                                time_factor(layout.estimator) * (time + 100.0)},
                               {"VN", velocity.y()},
                               {"VE", velocity.x()},
                               {"VD", -velocity.z()}});
    const double unit = is_old ? 100.0 : 1.0;  // stored as integers in hundredths
    log.add(layout.battery,
            {{is_old ? "TimeMS" : "TimeUS", time_factor(layout.battery) * (time + 100.01)},
             {"Volt", unit * volts},
             {"Curr", unit * measure_amperes(motion.flight_power(velocity) / volts)}});
  }
  return log.bytes();
}

std::string make_log(const Layout& layout, const Vehicle& vehicle) {
  return make_log(layout, vehicle, [](double amperes) { return amperes; });
}

double hover_error(const Calibration& found, const Vehicle& vehicle) {
  return found.hover_power / Motion(vehicle, {}).hover_power() - 1.0;
}

class LogLayouts : public testing::TestWithParam<std::size_t> {
 protected:
  static const Layout& layout() { return layouts()[GetParam()]; }
};

INSTANTIATE_TEST_SUITE_P(Calibration, LogLayouts, testing::Range<std::size_t>(0, 5),
                         [](const auto& test) { return std::string(layouts()[test.param].name); });

TEST_P(LogLayouts, YieldHoverPowerOfVehicle) {
  for (const double power : {150.0, 190.0, 215.0, 250.0, 400.0}) {
    const Vehicle vehicle = reference_vehicle(power);
    const Calibration found = calibrate(read_dataflash(make_log(layout(), vehicle)),
                                        vehicle_profile("generic_ardupilot"), 1.225);
    EXPECT_LT(std::abs(hover_error(found, vehicle)), 0.005) << power << " W";
    EXPECT_EQ(found.outliers, 0U);
    EXPECT_EQ(found.parameters, 1U);
  }
}

struct Damage {
  std::size_t lost = 0, corrupted = 0;  ///< number of bytes
};

std::string damaged(std::string log, const Damage& damage, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < damage.corrupted; ++i) {
    log[random() % log.size()] = static_cast<char>(random());
  }
  std::string kept;
  const double share = static_cast<double>(damage.lost) / static_cast<double>(log.size());
  std::uniform_real_distribution<double> draw(0.0, 1.0);
  for (const char byte : log) {
    if (draw(random) >= share) kept.push_back(byte);
  }
  return kept;
}

// Up to 1% of the bytes are lost or corrupted.
TEST_P(LogLayouts, YieldHoverPowerFromDamagedLogsOrReject) {
  const Vehicle vehicle = reference_vehicle(250.0);
  const std::string log = make_log(layout(), vehicle);
  int read = 0;
  for (const double share : {1e-4, 1e-3, 3e-3, 1e-2}) {
    const auto bytes = static_cast<std::size_t>(share * static_cast<double>(log.size()));
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      const Damage damage = seed % 2 == 0 ? Damage{.lost = bytes} : Damage{.corrupted = bytes};
      const std::string error_message = thrown_message([&] {
        const Calibration found = calibrate(read_dataflash(damaged(log, damage, seed)),
                                            vehicle_profile("generic_ardupilot"), 1.225);
        ++read;
        EXPECT_LT(std::abs(hover_error(found, vehicle)), 0.01)
            << 100.0 * share << " % of bytes, seed " << seed;
        EXPECT_LT(found.energy_error, 0.05);
      });
      EXPECT_THAT(error_message, testing::Not(HasSubstr("scatters"))) << share;
    }
  }
  EXPECT_GE(read, 6);  // the others have lost their FMT messages
}

const Layout& newest() { return layouts().back(); }

// The rotors of the model cannot be better than momentum theory. The hover power is still right,
// and a warning is given.
TEST(CalibrationBounds, KeepsHoverPowerAndWarnsAtRotorEfficiencyLimit) {
  Vehicle vehicle = reference_vehicle(250.0);
  vehicle.avionics_power = 110.0;
  for (const double scale : {0.6, 0.8, 0.86}) {
    const std::string log =
        make_log(newest(), vehicle, [&](double amperes) { return scale * amperes; });
    const Calibration found =
        calibrate(read_dataflash(log), vehicle_profile("generic_ardupilot"), 1.225);
    EXPECT_NEAR(found.hover_power, scale * Motion(vehicle, {}).hover_power(),
                0.005 * scale * 250.0);
    EXPECT_THAT(found.warnings, testing::Contains(HasSubstr("rotor efficiency is at its limit")));
    EXPECT_NO_THROW(Motion(found.vehicle, {}));
  }
}

// One leg north and one leg east cannot separate wind from drag. The wind is then zero, and the
// hover power is right.
TEST(CalibrationBounds, EstimatesNoWindWhenLogCannotSeparateItFromDrag) {
  const Vehicle vehicle = reference_vehicle(215.0);
  const Motion motion(vehicle, {});
  FlightLog log;
  for (int i = 0; i < 2400; ++i) {
    Vector3d velocity = Vector3d::Zero();
    if (i >= 1200) velocity = i < 1800 ? Vector3d(0, 4, 0) : Vector3d(8, 0, 0);
    log.samples.push_back({0.1 * i, velocity, motion.flight_power(velocity)});
  }
  const Calibration found = calibrate(log, vehicle_profile("generic_ardupilot"), 1.225);
  EXPECT_LT(found.wind.norm(), 0.5);
  EXPECT_LT(std::abs(hover_error(found, vehicle)), 0.005);
}

TEST(CalibrationBounds, WarnsWhenDragAreaIsAtItsLimit) {
  Vehicle vehicle = reference_vehicle(250.0);
  vehicle.drag_area = 0.0;
  const Calibration found = calibrate(read_dataflash(make_log(newest(), vehicle)),
                                      vehicle_profile("generic_ardupilot"), 1.225);
  EXPECT_THAT(found.warnings, testing::Contains(HasSubstr("drag_area is at its limit")));
}

// The result does not depend on the endurance that the preset states for its own mass.
TEST(CalibrationMass, IsAppliedWithoutChangingRotorDiameter) {
  for (const double mass : {1.0, 1.5, 2.5, 3.0}) {
    Vehicle vehicle = reference_vehicle(300.0);
    vehicle.mass = mass;
    const Calibration found = calibrate(read_dataflash(make_log(newest(), vehicle)),
                                        vehicle_profile("generic_ardupilot"), 1.225, mass);
    EXPECT_EQ(found.vehicle.mass, mass);
    EXPECT_EQ(found.vehicle.rotor_diameter, 0.3);
    EXPECT_LT(std::abs(hover_error(found, vehicle)), 0.005) << mass << " kg";
  }
}

// Rotors with a diameter of 0.3 m need 369 W to carry 4 kg.
TEST(CalibrationMass, EnlargesRotorsThatCannotCarryIt) {
  Vehicle vehicle = reference_vehicle(300.0);
  vehicle.mass = 4.0;
  vehicle.rotor_diameter = 0.3 * std::sqrt(2.0);
  const Calibration found = calibrate(read_dataflash(make_log(newest(), vehicle)),
                                      vehicle_profile("generic_ardupilot"), 1.225, 4.0);
  EXPECT_NEAR(found.vehicle.rotor_diameter, vehicle.rotor_diameter, 1e-9);
  EXPECT_THAT(found.warnings, testing::Contains(HasSubstr("rotor_diameter is set to 0.424 m")));
  EXPECT_LT(std::abs(hover_error(found, vehicle)), 0.005);
}

TEST(CalibrationErrors, NameTheCause) {
  const Vehicle vehicle = reference_vehicle(250.0);
  const auto error_message = [&](const auto& measure_amperes) {
    return thrown_message([&] {
      calibrate(read_dataflash(make_log(newest(), vehicle, measure_amperes)),
                vehicle_profile("generic_ardupilot"), 1.225);
    });
  };
  EXPECT_THAT(error_message([](double) { return 0.0; }),
              HasSubstr("contains no power measurements"));
  EXPECT_THAT(error_message([](double) { return 0.02; }),
              HasSubstr("contains no power measurements"));
  EXPECT_THAT(error_message([](double) { return std::nan(""); }), HasSubstr("contains no current"));
  EXPECT_THAT(
      error_message([](double amperes) { return 0.3 * amperes; }),
      HasSubstr(
          "2.00 kg on 4 rotors of 0.300 m need at least 130.5 W; set the take-off mass (--mass)"));
  EXPECT_THAT(error_message([&](double amperes) {
                static int count = 0;
                const double swing = count++ / 60 % 2 == 0 ? 1.7 : 1.0;  // period: 6 s
                return swing * amperes;
              }),
              HasSubstr("does not fit a power model: the residual scatter"));
}

TEST(CalibrationErrors, NameTheRequiredFlight) {
  FlightLog log = read_dataflash(make_log(newest(), reference_vehicle(250.0)));
  const auto error_message = [](const FlightLog& some) {
    return thrown_message([&] { calibrate(some, vehicle_profile("generic_ardupilot"), 1.225); });
  };
  FlightLog hovering = log, brief = log, level = log;
  for (LogSample& sample : hovering.samples) sample.velocity.setZero();
  std::erase_if(level.samples, [](const LogSample& s) { return s.velocity.norm() < 0.1; });
  brief.samples.resize(300);
  EXPECT_THAT(error_message(hovering),
              HasSubstr("required: at least 30 s: fly 4 level legs of 100 m"));
  EXPECT_THAT(error_message(level), HasSubstr("required: at least 20 s: hover in place for 30 s"));
  EXPECT_THAT(error_message(brief),
              HasSubstr("required: at least 120 s: hover for 60 s and fly 4"));
}

TEST(ForeignLogs, AreRejectedWithTheNameOfTheirFormat) {
  const auto kind = [](const std::string& bytes) {
    return thrown_message([&] { read_dataflash(bytes); });
  };
  using namespace std::string_literals;
  EXPECT_THAT(kind("FMT, 128, 89, FMT, BBnNZ, Type,Length\n"), HasSubstr("an ArduPilot text log"));
  EXPECT_THAT(kind("ULog\x01\x12\x35\x01 and so on"), HasSubstr("a PX4 ULog"));
  EXPECT_THAT(kind("\0\5\xE2\x1F\x3A\x10\x20\x30\xFD\x09rest"s), HasSubstr("(.tlog)"));
  EXPECT_THAT(kind("\0\5\xE2\x1F\x3A\x10\x20\x30\xFE\x09rest"s), HasSubstr("(.tlog)"));
  EXPECT_THAT(kind("\x1f\x8b\x08"), HasSubstr("gzip-compressed; unpack it first"));
  EXPECT_THAT(kind("H Product:Blackbox flight data recorder"), HasSubstr("Blackbox log"));
  EXPECT_THAT(kind("time_s,power_w\n1,2\n"), HasSubstr("the name of a CSV table must end in .csv"));
  EXPECT_THAT(kind(""), HasSubstr("it is empty"));
}

// ArduPilot master since October 2024: CMD lists the mission at its upload, MISE lists executed
// items.
TEST(ExecutedItems, AreReadFromMiseMessagesWhenLogged) {
  DataflashWriter log;
  const Layout& layout = newest();
  for (const LogFormat* format : {&layout.estimator, &layout.battery, &items, &executed}) {
    log.describe(*format);
  }
  const auto item = [&](const LogFormat& format, double time, double number) {
    log.add(format,
            {{"TimeUS", 1e6 * time}, {"CId", 16}, {"CNum", number}, {"Lat", 51.0 + 1e-3 * number}});
  };
  for (int i = 0; i < 5; ++i) item(items, 1.0, i);
  log.add(layout.estimator, {{"TimeUS", 1e6}});
  log.add(layout.battery, {{"TimeUS", 1.1e6}, {"Volt", 20}, {"Curr", 10}});
  for (int i = 0; i < 3; ++i) item(executed, 2.0 + i, i);
  const FlightLog read = read_dataflash(log.bytes());
  ASSERT_EQ(read.commands.size(), 3U);
  EXPECT_DOUBLE_EQ(read.commands[2].time, 4.0);
}

// Legs with equal timestamps are an uploaded list and not a flight. They contain no settle times.
TEST(ExecutedItems, AreNotUsedForSettleTimeWithoutTimes) {
  FlightLog log = read_dataflash(make_log(newest(), reference_vehicle(250.0)));
  const LocalFrame frame({51.0, 7.0, 0.0});
  for (int i = 0; i < 20; ++i) {
    const GeodeticPoint geodetic = frame.to_geodetic({20.0 * i, 0, 0});
    log.commands.push_back({1.0, 16, 0, 0, geodetic.latitude_deg, geodetic.longitude_deg, 30.0});
    log.commands.push_back({1.0, 93, 0.5, 0, 0, 0, 0});
  }
  const Calibration found = calibrate(log, vehicle_profile("generic_ardupilot"), 1.225);
  EXPECT_FALSE(found.settling);
  EXPECT_GE(found.legs_without_time, 15U);
  EXPECT_EQ(found.vehicle.mode.settle_time, vehicle_profile("generic_ardupilot").mode.settle_time);
}

// A vehicle that is restarted logs a second flight whose times start again at zero.
TEST(DataflashTimes, IncreaseAcrossVehicleRestart) {
  const Vehicle vehicle = reference_vehicle(250.0);
  const std::string log = make_log(newest(), vehicle);
  const FlightLog once = read_dataflash(log), twice = read_dataflash(log + log);
  EXPECT_GT(twice.samples.size(), 2 * once.samples.size() - 20);
  for (std::size_t i = 1; i < twice.samples.size(); ++i) {
    ASSERT_GT(twice.samples[i].time, twice.samples[i - 1].time);
  }
}

}  // namespace
}  // namespace skycap::flight
