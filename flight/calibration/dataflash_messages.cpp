#include "flight/calibration/dataflash_messages.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "flight/export/text.h"

namespace skycap::flight {
namespace {

constexpr unsigned char first_mark = 0xA3, second_mark = 0x95;
constexpr std::size_t header_size = 3;  // Two marks and the message type.
constexpr std::uint8_t format_type = 128;
constexpr std::size_t format_size = 89;  // Size of an FMT message including its header.
/// Maximum size of a message and the marks of the next one. Message sizes are stored in a byte.
constexpr std::size_t max_message = 255 + 2;

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

double number_at(const char* bytes, const DataflashFormat::Field& field) {
  switch (field.letter) {
    case 'b':
      return stored<std::int8_t>(bytes);
    case 'B':
    case 'M':
      return stored<std::uint8_t>(bytes);
    case 'h':
    case 'c':
      return field.unit * stored<std::int16_t>(bytes);
    case 'H':
    case 'C':
      return field.unit * stored<std::uint16_t>(bytes);
    case 'i':
    case 'e':
    case 'L':
      return field.unit * stored<std::int32_t>(bytes);
    case 'I':
    case 'E':
      return field.unit * stored<std::uint32_t>(bytes);
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

DataflashFormat parse_format(std::string_view body) {
  DataflashFormat format{text_at(body.substr(2, 4)), static_cast<unsigned char>(body[1]), {}};
  const std::string letters = text_at(body.substr(6, 16));
  const std::vector<std::string> labels = split(text_at(body.substr(22, 64)), ',');
  std::size_t offset = 0;
  for (std::size_t i = 0; i < std::min(letters.size(), labels.size()); ++i) {
    const FieldType* type = find_type(letters[i]);
    if (type == nullptr) break;  // Unknown type letter: the sizes will not match.
    format.fields.push_back({labels[i], type->letter, type->width, type->unit, offset});
    offset += type->width;
  }
  const bool is_whole = header_size + offset == format.size;
  if (!is_whole) format.fields.clear();
  return format;
}

}  // namespace

const DataflashFormat::Field* DataflashFormat::find(std::string_view label) const {
  const auto found = std::ranges::find(fields, label, &Field::label);
  return found == fields.end() ? nullptr : &*found;
}

std::optional<double> DataflashMessage::number(std::string_view label) const {
  const DataflashFormat::Field* field = format_.find(label);
  if (field == nullptr) return std::nullopt;
  return number_at(body_.data() + field->offset, *field);
}

std::string DataflashMessage::text(std::string_view label) const {
  const DataflashFormat::Field* field = format_.find(label);
  return field == nullptr ? "" : text_at(body_.substr(field->offset, field->width));
}

double DataflashMessage::time() const {
  const std::optional<double> microseconds = number("TimeUS");
  if (microseconds) return 1e-6 * *microseconds;
  // In GPS messages before Copter 3.3, TimeMS is the time of the week, and T that of the autopilot.
  return 1e-3 * number_or("T", number_or("TimeMS", 0.0));
}

std::optional<double> DataflashMessage::reading(std::string_view label) const {
  const DataflashFormat::Field* field = format_.find(label);
  if (field == nullptr) return std::nullopt;
  const double value = number_at(body_.data() + field->offset, *field);
  return field->letter == 'h' || field->letter == 'H' ? 0.01 * value : value;
}

std::optional<double> LogClock::read(double stated) {
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
  if (!keeps_gaps_ || stated + offset_ < *last_) offset_ = *last_ + forwards - stated;
  last_ = stated + offset_;
  strangers_ = 0;
  return last_;
}

std::size_t DataflashParser::parse(std::string_view bytes, bool is_last) {
  const auto has_marks = [&](std::size_t k) {
    return k + 1 < bytes.size() && static_cast<unsigned char>(bytes[k]) == first_mark &&
           static_cast<unsigned char>(bytes[k + 1]) == second_mark;
  };
  std::size_t i = 0;
  while (i + header_size <= bytes.size()) {
    if (!is_last && i + max_message > bytes.size()) break;
    const auto type = static_cast<std::uint8_t>(bytes[i + 2]);
    const bool is_format = type == format_type;
    const std::size_t size = is_format ? format_size : formats_[type] ? formats_[type]->size : 0;
    const bool is_message = has_marks(i) && size >= header_size;
    // A message with missing bytes overlaps the next one, so no message starts at its end.
    if (is_message && i + size > bytes.size()) {
      is_truncated_ = true;
      break;
    }
    if (!is_message || (i + size != bytes.size() && !has_marks(i + size))) {
      ++i, ++skipped_;
      continue;
    }
    const std::string_view body = bytes.substr(i + header_size, size - header_size);
    if (is_format) {
      DataflashFormat format = parse_format(body);
      std::optional<DataflashFormat>& known = formats_[static_cast<unsigned char>(body[0])];
      if (!known || known->fields.empty() || !format.fields.empty()) known = std::move(format);
      has_format_ = true;
    } else {
      receive_({*formats_[type], body});
    }
    i += size;
  }
  return i;
}

}  // namespace skycap::flight
