#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

#include "flight/calibration/dataflash_messages.h"
#include "flight/calibration/flight_log.h"
#include "flight/calibration/foreign_log.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

/// Builds the log from its messages.
class LogBuilder {
 public:
  explicit LogBuilder(std::size_t max_entries) : max_entries_(max_entries) {}

  void add(const DataflashMessage& message) {
    const std::string& name = message.name();
    if (name == "XKF1" || name == "NKF1" || name == "EKF1") set_velocity(message);
    if (const std::optional<double> battery = read_battery_number(message))
      add_sample(message, *battery);
    if (name == "PARM") {
      log_.parameters.push_back({message.text("Name"), message.number_or("Value", 0.0)});
    }
    if (name == "CMD") add_command(message, listed_);
    if (name == "MISE") add_command(message, log_.commands);
    if (samples_.size() + log_.parameters.size() + log_.commands.size() + listed_.size() >
        max_entries_) {
      throw Error(ErrorKind::bad_file, "contains more than " + std::to_string(max_entries_) +
                                           " samples, parameters and commands");
    }
  }

  /// Returns the log. `skipped` is the number of bytes outside of messages.
  FlightLog finish(std::size_t skipped) {
    const std::string damage =
        skipped == 0 ? "" : "; " + std::to_string(skipped) + " damaged bytes";
    add_samples();
    if (!has_velocity_) {
      throw Error(ErrorKind::bad_file,
                  "contains no velocity (XKF1); enable logging of the estimator state" + damage);
    }
    if (log_.samples.empty() && has_voltage_ && !has_current_) {
      throw Error(ErrorKind::bad_file,
                  "contains no current (BAT.Curr); a current sensor is required (BATT_MONITOR 4 or "
                  "higher)" +
                      damage);
    }
    if (log_.samples.empty()) {
      throw Error(ErrorKind::bad_file,
                  "contains no battery data (BAT); a power monitor is required" + damage);
    }
    // Since October 2024, CMD lists only the uploaded mission.
    if (log_.commands.empty()) log_.commands = std::move(listed_);
    return std::move(log_);
  }

 private:
  /// Returns the battery number of a message, or std::nullopt for other messages. Before Copter
  /// 4.0, the second battery has its own message.
  static std::optional<double> read_battery_number(const DataflashMessage& message) {
    const std::string& name = message.name();
    if (name == "BAT" || name == "CURR") {
      for (const char* label : {"Inst", "Instance"}) {
        if (const auto number = message.number(label)) return number;
      }
      return 0.0;
    }
    if (name == "BAT2" || name == "CUR2") return 1.0;
    return std::nullopt;
  }

  // Uses the first of several estimator cores.
  void set_velocity(const DataflashMessage& message) {
    constexpr double fastest = 100.0;  // Maximum plausible speed of a multicopter [m/s].
    const auto north = message.number("VN"), east = message.number("VE"),
               down = message.number("VD");
    if (!north || !east || !down || message.number_or("C", 0.0) != 0.0) return;
    const Eigen::Vector3d velocity(*east, *north, -*down);
    const std::optional<double> time = clock_.read(message.time());
    if (!time || !(velocity.norm() < fastest)) {
      ++log_.damaged;
      return;
    }
    velocity_ = velocity;
    velocity_time_ = *time;
    has_velocity_ = true;
  }

  void add_sample(const DataflashMessage& message, double battery) {
    constexpr double max_volts = 1000.0, max_amperes = 5000.0, oldest = 2.0;
    const auto volts = message.reading("Volt"), amperes = message.reading("Curr");
    if (!volts) return;
    has_voltage_ = true;
    if (!amperes || std::isnan(*amperes)) return;
    has_current_ = true;
    if (!has_velocity_) return;
    const std::optional<double> time = clock_.read(message.time());
    const bool is_possible = battery >= 0.0 && battery <= 255.0 && *volts >= 0.0 &&
                             *volts < max_volts && std::abs(*amperes) < max_amperes;
    if (!time || !is_possible) {
      ++log_.damaged;
      return;
    }
    if (*time - velocity_time_ > oldest) return;
    samples_.push_back({*time, velocity_, static_cast<std::uint8_t>(battery), *volts * *amperes});
  }

  /// Adds up the power of all batteries. A battery number with very few readings is damaged and
  /// ignored.
  void add_samples() {
    constexpr std::size_t min_fraction = 20;
    std::array<std::size_t, 256> counts{};
    for (const PowerSample& reading : samples_) ++counts[reading.battery];
    const std::size_t min_count = *std::ranges::max_element(counts) / min_fraction;
    std::map<std::uint8_t, double> powers;
    for (const PowerSample& reading : samples_) {
      if (counts[reading.battery] < min_count) {
        ++log_.damaged;
        continue;
      }
      powers[reading.battery] = reading.power;
      double power = 0.0;
      for (const auto& [battery, one] : powers) power += one;
      std::vector<LogSample>& samples = log_.samples;
      if (samples.empty() || reading.time > samples.back().time) {
        samples.push_back({reading.time, reading.velocity, power});
      }
    }
  }

  void add_command(const DataflashMessage& message, std::vector<LogCommand>& commands) {
    const double command = message.number_or("CId", 0.0);
    if (!(command >= 0.0 && command <= 65535.0)) return;
    const std::optional<double> time = clock_.read(message.time());
    if (!time) return;
    commands.push_back({*time, static_cast<int>(command), message.number_or("Prm1", 0.0),
                        message.number_or("Prm2", 0.0), message.number_or("Lat", 0.0),
                        message.number_or("Lng", 0.0), message.number_or("Alt", 0.0)});
  }

  /// Power of one battery at one time.
  struct PowerSample {
    double time = 0.0;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    std::uint8_t battery = 0;
    double power = 0.0;
  };

  std::size_t max_entries_;
  FlightLog log_;
  std::vector<LogCommand> listed_;  ///< Items from CMD.
  LogClock clock_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  double velocity_time_ = 0.0;
  bool has_velocity_ = false, has_voltage_ = false, has_current_ = false;
  std::vector<PowerSample> samples_;
};

}  // namespace

FlightLog read_dataflash(std::string_view bytes, std::size_t max_entries) {
  LogBuilder builder(max_entries);
  DataflashParser parser([&](const DataflashMessage& message) { builder.add(message); });
  parser.parse(bytes, true);
  if (!parser.has_format()) {
    const std::string kind = foreign_kind(bytes);
    throw Error(ErrorKind::bad_file, kind.empty()
                                         ? "is not a dataflash log: it defines no messages"
                                         : "is not an ArduPilot dataflash log: it is " + kind);
  }
  return builder.finish(parser.skipped());
}

}  // namespace skycap::flight
