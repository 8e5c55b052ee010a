/// Common parts of the readers: input files and allowed results.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "geometry/error.h"

namespace skycap::fuzz {

/// Throws std::logic_error, which is a finding, if `holds` is false.
inline void require(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

inline std::string bytes_to_string(const std::uint8_t* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

/// Runs a reader that may reject its input with an Error whose message contains `name`.
template <typename Read>
int run_reader(std::string_view name, Read read) {
  try {
    read();
  } catch (const Error& error) {
    require(std::string_view(error.what()).find(name) != std::string_view::npos,
            "the message does not name the input: " + std::string(error.what()));
  }
  return 0;
}

/// Returns a folder of this process, which each call empties.
std::filesystem::path fresh_folder();

/// Returns the path of a file with this name and these bytes, in a folder of this process.
std::filesystem::path file_with(std::string_view name, std::string_view bytes);

/// Returns an E57 file with valid page checksums for any content. Otherwise the data behind them
/// would not be read.
std::string sealed_e57(const std::string& pages);

}  // namespace skycap::fuzz
