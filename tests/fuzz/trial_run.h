/// What the bodies of readers share: a file to read from, and what a reader may do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "geometry/error.h"

namespace skycap::fuzz {

/// Throws std::logic_error: a finding.
inline void require(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

inline std::string bytes_to_string(const std::uint8_t* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

/// Runs a reader that may refuse its input by an Error whose message holds `name`.
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

/// A folder of this process, made anew by each call.
std::filesystem::path fresh_folder();

/// The path of a file of that name with these bytes, in a folder of this process.
std::filesystem::path file_with(std::string_view name, std::string_view bytes);

/// An E57 file with checksums that agree, whatever was changed: else nothing behind them would be
/// read.
std::string sealed_e57(const std::string& pages);

}  // namespace skycap::fuzz
