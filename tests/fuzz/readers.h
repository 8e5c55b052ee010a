/// Every reader of files that may come from anyone, as libFuzzer sees it: bytes in, and either a
/// value that makes sense or one Error. Anything else, such as another exception, a crash, a value
/// that the reader's header rules out, or an error that does not name the file, is a finding.
///
/// The bodies are compiled twice: into the corpus test, which replays tests/fuzz/corpus/NAME, and
/// by clang into the program that tests/fuzz/run lets loose on them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace skycap::fuzz {

struct Reader {
  std::string_view name;  ///< of its corpus, too
  /// Always 0, as libFuzzer wants it. Throws std::logic_error for a finding.
  int (*run)(const std::uint8_t* bytes, std::size_t size);
};

std::span<const Reader> surface_readers();  ///< meshes, clouds, measured free space
std::span<const Reader> route_readers();    ///< autopilots' files, trajectories, parameters
std::span<const Reader> prior_readers();    ///< city models
std::span<const Reader>
mission_readers();  ///< missions, campaigns, sensors, packages, trials, journals

/// The reader of that name, or null.
const Reader* find_reader(std::string_view name);

}  // namespace skycap::fuzz
