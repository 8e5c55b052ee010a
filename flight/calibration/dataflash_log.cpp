#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>

#include "flight/calibration/flight_log.h"
#include "flight/export/text.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

constexpr unsigned char first_mark = 0xA3, second_mark = 0x95;
constexpr std::size_t header_size = 3;  // the marks and the type
constexpr std::uint8_t format_type = 128;
constexpr std::size_t format_size = 89;  // of a FMT message, header included

/// A type letter's width, and what a stored unit is worth.
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

/// Text that ends at a zero or with its field.
std::string text_at(std::string_view field) {
  return std::string(field.substr(0, std::min(field.find('\0'), field.size())));
}

struct Field {
  std::string label;
  FieldType type;
  std::size_t offset;  ///< after the header
};

/// What a FMT message says of the messages of one type.
struct Format {
  std::string name;
  std::size_t size = 0;  ///< header included
  std::vector<Field> fields;

  const Field* find(std::string_view label) const {
    const auto found = std::ranges::find(fields, label, &Field::label);
    return found == fields.end() ? nullptr : &*found;
  }
};

Format format_of(std::string_view body) {
  Format format{text_at(body.substr(2, 4)), static_cast<unsigned char>(body[1]), {}};
  const std::string letters = text_at(body.substr(6, 16));
  const std::vector<std::string> labels = split(text_at(body.substr(22, 64)), ',');
  std::size_t offset = 0;
  for (std::size_t i = 0; i < std::min(letters.size(), labels.size()); ++i) {
    const FieldType* type = find_type(letters[i]);
    if (type == nullptr) break;  // a letter that is not known: nothing after it is in its place
    format.fields.push_back({labels[i], *type, offset});
    offset += type->width;
  }
  const bool is_whole = header_size + offset <= format.size;
  if (!is_whole) format.fields.clear();
  return format;
}

/// One message with the format that its type has.
class Message {
 public:
  Message(const Format& format, std::string_view body) : format_(format), body_(body) {}

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
  double time() const { return 1e-6 * number_or("TimeUS", 0.0); }

 private:
  const Format& format_;
  std::string_view body_;
};

/// Takes in message after message.
class LogBuilder {
 public:
  explicit LogBuilder(std::size_t most_entries) : most_entries_(most_entries) {}

  void add(const Message& message) {
    if (message.name() == "XKF1" || message.name() == "NKF1") set_velocity(message);
    if (message.name() == "BAT") add_sample(message);
    if (message.name() == "PARM") {
      log_.parameters.push_back({message.text("Name"), message.number_or("Value", 0.0)});
    }
    if (message.name() == "CMD") add_command(message);
    if (log_.samples.size() + log_.parameters.size() + log_.commands.size() > most_entries_) {
      throw Error(ErrorKind::bad_file, "holds more than " + std::to_string(most_entries_) +
                                           " samples, parameters and commands");
    }
  }

  FlightLog finish() {
    if (!has_velocity_) {
      throw Error(ErrorKind::bad_file, "holds no velocity (XKF1); log the estimator's state");
    }
    if (log_.samples.empty()) {
      throw Error(ErrorKind::bad_file, "holds no battery (BAT); the vehicle needs a power monitor");
    }
    return std::move(log_);
  }

 private:
  // Of several cores of the estimator, the first.
  void set_velocity(const Message& message) {
    const auto north = message.number("VN"), east = message.number("VE"),
               down = message.number("VD");
    if (!north || !east || !down || message.number_or("C", 0.0) != 0.0) return;
    velocity_ = {*east, *north, -*down};
    has_velocity_ = velocity_.allFinite();
  }

  void add_sample(const Message& message) {
    const auto volts = message.number("Volt"), amperes = message.number("Curr");
    if (!volts || !amperes || !has_velocity_) return;
    const double battery = message.number_or("Inst", message.number_or("Instance", 0.0));
    if (!(battery >= 0.0 && battery <= 255.0)) return;
    power_[battery] = *volts * *amperes;
    double power = 0.0;
    for (const auto& [number, one] : power_) power += one;
    if (!std::isfinite(power)) return;
    // A time that was damaged is later than the one before and than the one after it.
    std::vector<LogSample>& samples = log_.samples;
    const auto is_after = [&](std::size_t from_end) {
      return samples.size() < from_end || message.time() > samples[samples.size() - from_end].time;
    };
    if (!is_after(1) && is_after(2)) samples.pop_back();
    if (is_after(1)) samples.push_back({message.time(), velocity_, power});
  }

  void add_command(const Message& message) {
    const double command = message.number_or("CId", 0.0);
    if (!(command >= 0.0 && command <= 65535.0)) return;
    log_.commands.push_back({message.time(), static_cast<int>(command),
                             message.number_or("Prm1", 0.0), message.number_or("Prm2", 0.0),
                             message.number_or("Lat", 0.0), message.number_or("Lng", 0.0),
                             message.number_or("Alt", 0.0)});
  }

  std::size_t most_entries_;
  FlightLog log_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  bool has_velocity_ = false;
  std::map<double, double> power_;  ///< by battery
};

}  // namespace

FlightLog read_dataflash(std::string_view bytes, std::size_t most_entries) {
  std::array<std::optional<Format>, 256> formats;
  LogBuilder builder(most_entries);
  bool has_format = false;
  std::size_t i = 0;
  while (i + header_size <= bytes.size()) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(bytes[i + k]); };
    const std::uint8_t type = byte(2);
    const bool is_format = type == format_type;
    const std::size_t size = is_format ? format_size : formats[type] ? formats[type]->size : 0;
    if (byte(0) != first_mark || byte(1) != second_mark || size < header_size) {
      ++i;
      continue;
    }
    if (i + size > bytes.size()) break;
    const std::string_view body = bytes.substr(i + header_size, size - header_size);
    if (is_format) {
      formats[static_cast<unsigned char>(body[0])] = format_of(body);
      has_format = true;
    } else {
      builder.add({*formats[type], body});
    }
    i += size;
  }
  if (!has_format) throw Error(ErrorKind::bad_file, "is no dataflash log: it describes no message");
  return builder.finish();
}

}  // namespace skycap::flight
