#include "flight/flown/ulog_file.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

constexpr std::string_view magic("ULog\x01\x12\x35", 7);
constexpr std::size_t file_header = 16, message_header = 3;
/// Synchronisation message, with its header.
constexpr std::string_view sync("\x08\x00S\x2F\x73\x13\x20\x25\x0C\xBB\x12", 11);
constexpr std::string_view known_types = "BFIMPQADRLCSO";
/// Maximum depth of nested types, and maximum number of elements of a field.
constexpr int max_depth = 8;
constexpr std::size_t max_elements = 65535;

static_assert(std::endian::native == std::endian::little);

template <typename T>
T number_at(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Returns the size of a basic type [bytes]; 0 for other types.
std::size_t type_size(std::string_view type) {
  if (type == "int8_t" || type == "uint8_t" || type == "bool" || type == "char") return 1;
  if (type == "int16_t" || type == "uint16_t") return 2;
  if (type == "int32_t" || type == "uint32_t" || type == "float") return 4;
  if (type == "int64_t" || type == "uint64_t" || type == "double") return 8;
  return 0;
}

double number_at(const char* bytes, std::string_view type) {
  if (type == "float") return number_at<float>(bytes);
  if (type == "double") return number_at<double>(bytes);
  if (type == "int8_t") return number_at<std::int8_t>(bytes);
  if (type == "int16_t") return number_at<std::int16_t>(bytes);
  if (type == "uint16_t") return number_at<std::uint16_t>(bytes);
  if (type == "int32_t") return number_at<std::int32_t>(bytes);
  if (type == "uint32_t") return number_at<std::uint32_t>(bytes);
  if (type == "int64_t") return static_cast<double>(number_at<std::int64_t>(bytes));
  if (type == "uint64_t") return static_cast<double>(number_at<std::uint64_t>(bytes));
  return number_at<std::uint8_t>(bytes);
}

/// Removes the text before `separator` from `rest` and returns it.
std::string_view take(std::string_view& rest, char separator) {
  const std::size_t end = std::min(rest.find(separator), rest.size());
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

}  // namespace

std::optional<double> UlogMessage::number(std::string_view name, std::size_t index) const {
  const auto field = std::ranges::find(fields_, name, &UlogField::name);
  if (field == fields_.end() || index >= field->count) return std::nullopt;
  const std::size_t size = type_size(field->type), offset = field->offset + index * size;
  if (offset + size > data_.size()) return std::nullopt;
  return number_at(data_.data() + offset, field->type);
}

std::optional<std::array<double, 4>> UlogMessage::quaternion(std::string_view name) const {
  std::array<double, 4> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = number(name, i);
    if (!value) return std::nullopt;
    values[i] = *value;
  }
  return values;
}

std::optional<std::size_t> UlogParser::add_fields(const std::string& type,
                                                  const std::string& prefix, std::size_t offset,
                                                  int depth, std::vector<UlogField>& fields) const {
  const auto format = formats_.find(type);
  if (format == formats_.end() || depth > max_depth) return std::nullopt;
  for (std::string_view rest = format->second; !rest.empty();) {
    std::string_view name = take(rest, ';');
    std::string_view kind = take(name, ' ');
    std::string_view array = kind;
    kind = take(array, '[');
    std::size_t count = 1;
    if (!array.empty()) {
      const auto read = std::from_chars(array.data(), array.data() + array.size(), count);
      if (read.ec != std::errc() || count > max_elements) return std::nullopt;
    }
    if (kind.empty() || name.empty()) continue;
    const std::string full_name = prefix + std::string(name);
    if (const std::size_t size = type_size(kind); size > 0) {
      fields.push_back({std::string(kind), full_name, offset, count});
      offset += size * count;
      continue;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::string element = count > 1 ? "[" + std::to_string(i) + "]" : "";
      const auto end =
          add_fields(std::string(kind), full_name + element + ".", offset, depth + 1, fields);
      if (!end || fields.size() > max_elements) return std::nullopt;
      offset = *end;
    }
  }
  return offset;
}

void UlogParser::read_format(std::string_view body) {
  const std::size_t colon = body.find(':');
  if (colon == std::string_view::npos) return;
  formats_[std::string(body.substr(0, colon))] = std::string(body.substr(colon + 1));
}

void UlogParser::read_flags(std::string_view body) {
  constexpr std::size_t incompatible = 8, offsets = 16, num_offsets = 3;
  if (body.size() < offsets + 8 * num_offsets) return;
  const bool has_appended = (static_cast<unsigned char>(body[incompatible]) & 1U) != 0;
  for (std::size_t i = 0; has_appended && i < num_offsets; ++i) {
    const auto offset = number_at<std::uint64_t>(body.data() + offsets + 8 * i);
    if (offset > 0) appended_.push_back(offset);
  }
}

void UlogParser::subscribe(std::string_view body) {
  if (body.size() <= 3) return;
  Subscription subscription{std::string(body.substr(3)), static_cast<unsigned char>(body[0]), {}};
  // The fields before one of an unknown type keep their offsets.
  add_fields(subscription.topic, "", 0, 0, subscription.fields);
  subscriptions_[number_at<std::uint16_t>(body.data() + 1)] = std::move(subscription);
}

void UlogParser::read_message(char type, std::string_view body) {
  switch (type) {
    case 'B':
      return read_flags(body);
    case 'F':
      return read_format(body);
    case 'A':
      return subscribe(body);
    case 'O':
      if (body.size() >= 2) {
        ++dropouts_;
        dropped_ += 1e-3 * number_at<std::uint16_t>(body.data());
      }
      return;
    case 'D': {
      if (body.size() < 2) return;
      const auto found = subscriptions_.find(number_at<std::uint16_t>(body.data()));
      if (found == subscriptions_.end()) return;
      const Subscription& topic = found->second;
      return receive_({topic.topic, topic.instance, topic.fields, body.substr(2)});
    }
    default:
      return;
  }
}

std::size_t UlogParser::parse(std::string_view bytes, bool is_last) {
  std::size_t i = 0;
  if (!has_header_) {
    if (bytes.size() < file_header || !bytes.starts_with(magic)) {
      throw Error(ErrorKind::bad_file, "is not a PX4 ULog");
    }
    has_header_ = true;
    i = file_header;
  }
  const std::uint64_t begin = position_;
  while (i < bytes.size()) {
    if (is_lost_) {
      const std::size_t found = bytes.find(sync, i);
      const std::size_t end = found != std::string_view::npos ? found
                              : is_last || bytes.size() - i < sync.size()
                                  ? (is_last ? bytes.size() : i)
                                  : bytes.size() - (sync.size() - 1);
      skipped_ += end - i;
      i = end;
      if (found == std::string_view::npos) break;
      is_lost_ = false;
    }
    if (i + message_header > bytes.size()) {
      is_truncated_ = is_last;
      break;
    }
    const std::size_t size = number_at<std::uint16_t>(bytes.data() + i);
    const char type = bytes[i + 2];
    const std::size_t end = i + message_header + size;
    // Data appended after a crash may begin inside the last message before it.
    const auto appended = std::ranges::find_if(appended_, [&](std::uint64_t offset) {
      return offset > begin + i && offset < begin + end;
    });
    if (appended != appended_.end() && *appended - begin <= bytes.size()) {
      skipped_ += *appended - begin - i;
      i = *appended - begin;
      continue;
    }
    if (size == 0 || known_types.find(type) == std::string_view::npos) {
      is_lost_ = true;
      continue;
    }
    if (end > bytes.size()) {
      // A damaged size can point past the end of the file.
      if (is_last && bytes.find(sync, i + 1) != std::string_view::npos) {
        ++i, ++skipped_;
        is_lost_ = true;
        continue;
      }
      is_truncated_ = is_last;
      break;
    }
    read_message(type, bytes.substr(i + message_header, size));
    i = end;
  }
  position_ = begin + i;
  return i;
}

}  // namespace skycap::flight
