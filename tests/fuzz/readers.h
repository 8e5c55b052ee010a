/// All readers of untrusted files as libFuzzer targets: bytes in, and either a valid value or an
/// Error out. Anything else is a finding: another exception, a crash, a value that the reader's
/// header excludes, or an error without the file name.
///
/// The targets are compiled twice: for the corpus test, which replays tests/fuzz/corpus/NAME, and
/// with clang for the fuzzer that tests/fuzz/run starts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace skycap::fuzz {

struct Reader {
  std::string_view name;  ///< also the name of its corpus
  /// Always returns 0, as libFuzzer requires. Throws std::logic_error for a finding.
  int (*run)(const std::uint8_t* bytes, std::size_t size) = nullptr;
};

std::span<const Reader> surface_readers();  ///< meshes, clouds, measured free space
std::span<const Reader> route_readers();    ///< mission files, trajectories, parameters
std::span<const Reader> table_readers();    ///< imported routes, tables, tiles, stored results
std::span<const Reader> prior_readers();    ///< maps, terrain, city models, earlier scans
std::span<const Reader> studio_readers();   ///< requests to the studio, edits of missions
std::span<const Reader> link_readers();     ///< MAVLink, messages of live surveys
std::span<const Reader> record_readers();   ///< recordings, journals, results
std::span<const Reader>
mission_readers();  ///< missions, campaigns, districts, sensors, packages, trials, journals

/// Returns the readers of ROS 2 messages. Only available with Cyclone DDS.
std::span<const Reader> ros2_readers();

/// Returns all readers.
std::vector<Reader> all_readers();

/// Returns the reader with this name. Its `run` is null if the name is unknown.
Reader find_reader(std::string_view name);

}  // namespace skycap::fuzz
