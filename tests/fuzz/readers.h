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
#include <vector>

namespace skycap::fuzz {

struct Reader {
  std::string_view name;  ///< of its corpus, too
  /// Always 0, as libFuzzer wants it. Throws std::logic_error for a finding.
  int (*run)(const std::uint8_t* bytes, std::size_t size) = nullptr;
};

std::span<const Reader> surface_readers();  ///< meshes, clouds, measured free space
std::span<const Reader> route_readers();    ///< autopilots' files, trajectories, parameters
std::span<const Reader> prior_readers();    ///< city models, earlier scans
std::span<const Reader> link_readers();     ///< MAVLink, messages of live surveys
std::span<const Reader> record_readers();   ///< recordings, journals, results
std::span<const Reader>
mission_readers();  ///< missions, campaigns, districts, sensors, packages, trials, journals

/// Messages of ROS 2; only where Cyclone DDS is.
std::span<const Reader> ros2_readers();

/// All of them.
std::vector<Reader> all_readers();

/// The reader of that name; its `run` is null if there is none.
Reader find_reader(std::string_view name);

}  // namespace skycap::fuzz
