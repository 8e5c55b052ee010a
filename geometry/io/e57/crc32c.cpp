#include "geometry/io/e57/crc32c.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace skycap::geometry::e57 {
namespace {

// Processes eight bytes per step. Table k is for a byte followed by k others.
using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr Tables make_tables() {
  constexpr std::uint32_t reflected_polynomial = 0x82F63B78;
  Tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t sum = byte;
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ ((sum & 1) != 0 ? reflected_polynomial : 0);
    tables[0][byte] = sum;
  }
  for (std::size_t k = 1; k < tables.size(); ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t sum = tables[k - 1][byte];
      tables[k][byte] = sum >> 8 ^ tables[0][sum & 0xFF];
    }
  }
  return tables;
}

constexpr Tables tables = make_tables();

}  // namespace

std::uint32_t crc32c(std::string_view bytes) {
  static_assert(std::endian::native == std::endian::little, "steps take the lowest byte first");
  std::uint32_t sum = 0xFFFFFFFF;
  for (; bytes.size() >= 8; bytes.remove_prefix(8)) {
    std::uint64_t step = 0;
    std::memcpy(&step, bytes.data(), sizeof step);
    step ^= sum;
    sum = 0;
    for (std::size_t k = 0; k < 8; ++k) sum ^= tables[7 - k][step >> 8 * k & 0xFF];
  }
  for (const char byte : bytes) {
    sum = sum >> 8 ^ tables[0][(sum ^ static_cast<std::uint8_t>(byte)) & 0xFF];
  }
  return ~sum;
}

}  // namespace skycap::geometry::e57
