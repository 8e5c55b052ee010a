/// CRC-32C (Castagnoli; RFC 3720, appendix B.4): the checksum of a page of an E57 file.
#pragma once

#include <cstdint>
#include <string_view>

namespace skycap::geometry::e57 {

std::uint32_t crc32c(std::string_view bytes);

}  // namespace skycap::geometry::e57
