#include "missions/cli/clouds/scan_results.h"

#include <fmt/format.h>

#include "geometry/io/record_log.h"
#include "missions/package/package.h"

namespace skycap::missions::cli {

scan::ScanFlight make_scan_flight(const ScanCommandOptions& options,
                                  const scan::ScanFlightOptions& scan, std::uint64_t seed,
                                  scan::Platform platform) {
  return scan::scan_flight(scan, seed, options.mission.parent_path(), options.route, platform);
}

nlohmann::ordered_json make_identity(const config::SensorDescription& sensor,
                                     const scene::SensedScene& scene,
                                     const scan::ScanFlight& flight) {
  return {{"sensor", sensor.name},
          {"sensor_digest", fmt::format("{:08x}", geometry::compute_crc32(sensor.text))},
          {"scene_digest", scene.content_checksum()},
          {"route_digest", compute_checksum(flight)}};
}

nlohmann::ordered_json open_journal(scan::ScanJournal& journal, bool resumes,
                                    const ScanCommandOptions& options, const support::Identity& run,
                                    const nlohmann::ordered_json& identity,
                                    const Console& console) {
  nlohmann::ordered_json begun = journal.open(run, identity, resumes);
  if (begun.is_object() && !options.is_quiet) {
    console.err << "resuming an interrupted scan\n" << std::flush;
  }
  return begun;
}

void commit_scan(geometry::OutputFolder& folder, bool is_complete) {
  if (!is_complete && package::is_complete_result(folder.path() / scan_name)) {
    folder.move_to("interrupted");
  }
  folder.commit();
}

}  // namespace skycap::missions::cli
