/// Returns the CRC-32C checksum (Castagnoli; RFC 3720, appendix B.4), which protects the pages of
/// E57 files.
#pragma once

#include <cstdint>
#include <string_view>

namespace skycap::geometry::e57 {

std::uint32_t crc32c(std::string_view bytes);

}  // namespace skycap::geometry::e57
