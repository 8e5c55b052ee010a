#include "tests/flight/calibration/dataflash_writer.h"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "flight/export/text.h"

namespace skycap::flight {
namespace {

std::size_t field_width(char letter) {
  switch (letter) {
    case 'b':
    case 'B':
    case 'M':
      return 1;
    case 'h':
    case 'H':
    case 'c':
    case 'C':
      return 2;
    case 'i':
    case 'I':
    case 'e':
    case 'E':
    case 'L':
    case 'f':
    case 'n':
      return 4;
    case 'd':
    case 'q':
    case 'Q':
      return 8;
    case 'N':
      return 16;
    case 'Z':
      return 64;
    default:
      throw std::logic_error("unknown letter");
  }
}

template <class T>
std::string raw(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string number(char letter, double value) {
  switch (letter) {
    case 'f':
      return raw(static_cast<float>(value));
    case 'd':
      return raw(value);
    case 'L':
      return raw(static_cast<std::int32_t>(std::llround(value * 1e7)));
    case 'c':
      return raw(static_cast<std::int16_t>(std::llround(value * 100.0)));
    case 'C':
      return raw(static_cast<std::uint16_t>(std::llround(value * 100.0)));
    case 'e':
    case 'E':
      return raw(static_cast<std::int32_t>(std::llround(value * 100.0)));
    default: {
      const std::string bytes = raw(static_cast<std::int64_t>(std::llround(value)));
      return bytes.substr(0, field_width(letter));
    }
  }
}

}  // namespace

std::size_t compute_size(const LogFormat& format) {
  std::size_t size = 3;
  for (const char letter : format.letters) size += field_width(letter);
  return size;
}

void DataflashWriter::begin(std::uint8_t type) {
  bytes_ += {'\xA3', '\x95', static_cast<char>(type)};
}

void DataflashWriter::put_text(std::string text, std::size_t size) {
  text.resize(size, '\0');
  bytes_ += text;
}

void DataflashWriter::describe(const LogFormat& format) {
  begin(128);
  bytes_ += {static_cast<char>(format.type), static_cast<char>(compute_size(format))};
  put_text(format.name, 4), put_text(format.letters, 16), put_text(format.labels, 64);
}

void DataflashWriter::add(const LogFormat& format, const std::map<std::string, double>& values,
                          const std::string& text) {
  begin(format.type);
  const std::vector<std::string> labels = split(format.labels, ',');
  for (std::size_t i = 0; i < format.letters.size(); ++i) {
    const char letter = format.letters[i];
    if (letter == 'N' || letter == 'n' || letter == 'Z') {
      put_text(text, field_width(letter));
      continue;
    }
    const auto found = values.find(labels.at(i));
    bytes_ += number(letter, found == values.end() ? 0.0 : found->second);
  }
}

}  // namespace skycap::flight
