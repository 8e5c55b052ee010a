#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>

#include "flight/calibration/flight_log.h"
#include "flight/calibration/foreign_log.h"
#include "flight/export/text.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

constexpr unsigned char first_mark = 0xA3, second_mark = 0x95;
constexpr std::size_t header_size = 3;  // Two marks and the message type.
constexpr std::uint8_t format_type = 128;
constexpr std::size_t format_size = 89;  // Size of an FMT message including its header.

/// Width of a field type in bytes, and the unit of its stored values.
struct FieldType {
  char letter;
  std::size_t width;
  double unit;
};

constexpr std::array<FieldType, 21> field_types{
    {{'b', 1, 1},    {'B', 1, 1},  {'M', 1, 1}, {'h', 2, 1},    {'H', 2, 1},    {'c', 2, 0.01},
     {'C', 2, 0.01}, {'i', 4, 1},  {'I', 4, 1}, {'e', 4, 0.01}, {'E', 4, 0.01}, {'L', 4, 1e-7},
     {'f', 4, 1},    {'d', 8, 1},  {'q', 8, 1}, {'Q', 8, 1},    {'n', 4, 0},    {'N', 16, 0},
     {'Z', 64, 0},   {'a', 64, 0}, {'g', 2, 0}}};

const FieldType* find_type(char letter) {
  const auto found = std::ranges::find(field_types, letter, &FieldType::letter);
  return found == field_types.end() ? nullptr : &*found;
}

static_assert(std::endian::native == std::endian::little);

template <typename T>
double stored(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double number_at(const char* bytes, const FieldType& type) {
  switch (type.letter) {
    case 'b':
      return stored<std::int8_t>(bytes);
    case 'B':
    case 'M':
      return stored<std::uint8_t>(bytes);
    case 'h':
    case 'c':
      return type.unit * stored<std::int16_t>(bytes);
    case 'H':
    case 'C':
      return type.unit * stored<std::uint16_t>(bytes);
    case 'i':
    case 'e':
    case 'L':
      return type.unit * stored<std::int32_t>(bytes);
    case 'I':
    case 'E':
      return type.unit * stored<std::uint32_t>(bytes);
    case 'f':
      return stored<float>(bytes);
    case 'd':
      return stored<double>(bytes);
    case 'q':
      return stored<std::int64_t>(bytes);
    case 'Q':
      return stored<std::uint64_t>(bytes);
    default:
      return 0.0;
  }
}

/// Returns text that ends at a zero or at the end of its field.
std::string text_at(std::string_view field) {
  return std::string(field.substr(0, std::min(field.find('\0'), field.size())));
}

struct Field {
  std::string label;
  FieldType type;
  std::size_t offset;  ///< Offset after the header.
};

/// Format of the messages of one type, from an FMT message.
struct MessageFormat {
  std::string name;
  std::size_t size = 0;  ///< Size including the header.
  std::vector<Field> fields;

  const Field* find(std::string_view label) const {
    const auto found = std::ranges::find(fields, label, &Field::label);
    return found == fields.end() ? nullptr : &*found;
  }
};

MessageFormat parse_format(std::string_view body) {
  MessageFormat format{text_at(body.substr(2, 4)), static_cast<unsigned char>(body[1]), {}};
  const std::string letters = text_at(body.substr(6, 16));
  const std::vector<std::string> labels = split(text_at(body.substr(22, 64)), ',');
  std::size_t offset = 0;
  for (std::size_t i = 0; i < std::min(letters.size(), labels.size()); ++i) {
    const FieldType* type = find_type(letters[i]);
    if (type == nullptr) break;  // Unknown type letter: the sizes will not match.
    format.fields.push_back({labels[i], *type, offset});
    offset += type->width;
  }
  const bool is_whole = header_size + offset == format.size;
  if (!is_whole) format.fields.clear();
  return format;
}

/// Message with the format of its type.
class Message {
 public:
  Message(const MessageFormat& format, std::string_view body) : format_(format), body_(body) {}

  const std::string& name() const { return format_.name; }

  std::optional<double> number(std::string_view label) const {
    const Field* field = format_.find(label);
    if (field == nullptr) return std::nullopt;
    return number_at(body_.data() + field->offset, field->type);
  }
  double number_or(std::string_view label, double otherwise) const {
    return number(label).value_or(otherwise);
  }
  std::string text(std::string_view label) const {
    const Field* field = format_.find(label);
    return field == nullptr ? "" : text_at(body_.substr(field->offset, field->type.width));
  }
  /// Returns the time [s]. Logs before Copter 3.3 store milliseconds.
  double time() const {
    const std::optional<double> microseconds = number("TimeUS");
    return microseconds ? 1e-6 * *microseconds : 1e-3 * number_or("TimeMS", 0.0);
  }

  /// Returns a reading. Logs before Copter 3.3 store it as an integer in hundredths.
  std::optional<double> reading(std::string_view label) const {
    const Field* field = format_.find(label);
    if (field == nullptr) return std::nullopt;
    const double value = number_at(body_.data() + field->offset, field->type);
    return field->type.letter == 'h' || field->type.letter == 'H' ? 0.01 * value : value;
  }

 private:
  const MessageFormat& format_;
  std::string_view body_;
};

/// Message times, which ascend except for damage and restarts.
class Clock {
 public:
  /// Returns the continuous time [s], or std::nullopt for a damaged message.
  std::optional<double> read(double stated) {
    const double time = stated + offset_;
    const bool is_next = last_ && time > *last_ - backwards && time < *last_ + forwards;
    if (!last_ || is_next) {
      last_ = last_ ? std::max(*last_, time) : time;
      strangers_ = 0;
      return time;
    }
    // Several messages near a different time indicate a restart, or a log that was paused.
    const bool is_same = strangers_ > 0 && std::abs(stated - stranger_) < forwards;
    strangers_ = is_same ? strangers_ + 1 : 1;
    stranger_ = stated;
    if (strangers_ < enough) return std::nullopt;
    offset_ = *last_ + forwards - stated;
    last_ = stated + offset_;
    strangers_ = 0;
    return last_;
  }

 private:
  /// Limits between consecutive messages [s].
  static constexpr double backwards = 1.0, forwards = 10.0;
  static constexpr int enough = 10;

  double offset_ = 0.0, stranger_ = 0.0;
  std::optional<double> last_;
  int strangers_ = 0;
};

/// Builds the log from its messages.
class LogBuilder {
 public:
  explicit LogBuilder(std::size_t max_entries) : max_entries_(max_entries) {}

  void add(const Message& message) {
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
  static std::optional<double> read_battery_number(const Message& message) {
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
  void set_velocity(const Message& message) {
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

  void add_sample(const Message& message, double battery) {
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

  void add_command(const Message& message, std::vector<LogCommand>& commands) {
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
  Clock clock_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  double velocity_time_ = 0.0;
  bool has_velocity_ = false, has_voltage_ = false, has_current_ = false;
  std::vector<PowerSample> samples_;
};

}  // namespace

FlightLog read_dataflash(std::string_view bytes, std::size_t max_entries) {
  std::array<std::optional<MessageFormat>, 256> formats;
  LogBuilder builder(max_entries);
  bool has_format = false;
  std::size_t skipped = 0;
  const auto has_marks = [&](std::size_t k) {
    return k + 1 < bytes.size() && static_cast<unsigned char>(bytes[k]) == first_mark &&
           static_cast<unsigned char>(bytes[k + 1]) == second_mark;
  };
  std::size_t i = 0;
  while (i + header_size <= bytes.size()) {
    const auto type = static_cast<std::uint8_t>(bytes[i + 2]);
    const bool is_format = type == format_type;
    const std::size_t size = is_format ? format_size : formats[type] ? formats[type]->size : 0;
    const bool is_message = has_marks(i) && size >= header_size;
    // A message with missing bytes overlaps the next one, so no message starts at its end.
    if (is_message && i + size > bytes.size()) break;
    if (!is_message || (i + size != bytes.size() && !has_marks(i + size))) {
      ++i, ++skipped;
      continue;
    }
    const std::string_view body = bytes.substr(i + header_size, size - header_size);
    if (is_format) {
      MessageFormat format = parse_format(body);
      std::optional<MessageFormat>& known = formats[static_cast<unsigned char>(body[0])];
      if (!known || known->fields.empty() || !format.fields.empty()) known = std::move(format);
      has_format = true;
    } else {
      builder.add({*formats[type], body});
    }
    i += size;
  }
  if (!has_format) {
    const std::string kind = foreign_kind(bytes);
    throw Error(ErrorKind::bad_file, kind.empty()
                                         ? "is not a dataflash log: it defines no messages"
                                         : "is not an ArduPilot dataflash log: it is " + kind);
  }
  return builder.finish(skipped);
}

}  // namespace skycap::flight
