#include "missions/verbs/clouds/scan_results.h"

#include <fmt/format.h>

#include "geometry/io/record_log.h"
#include "missions/package/package.h"

namespace skycap::missions::verbs {

recording::ScanFlight flown_by(const ScanVerbOptions& options, const file::Mission& mission,
                               recording::Carrier carrier) {
  return recording::scan_flight(mission, options.mission.parent_path(), options.route, carrier);
}

nlohmann::ordered_json identity_of(const equipment::SensorDescription& sensor,
                                   const scene::SensedScene& scene,
                                   const recording::ScanFlight& flight) {
  return {{"sensor", sensor.name},
          {"sensor_digest", fmt::format("{:08x}", geometry::crc32_of(sensor.text))},
          {"scene_digest", scene.digest()},
          {"route_digest", digest_of(flight)}};
}

nlohmann::ordered_json open_journal(recording::ScanJournal& journal, bool resumes,
                                    const ScanVerbOptions& options, const file::Mission& mission,
                                    const nlohmann::ordered_json& identity,
                                    const Console& console) {
  nlohmann::ordered_json begun = journal.open(mission, identity, resumes);
  if (begun.is_object() && !options.is_quiet) {
    console.err << "going on with an interrupted scan\n" << std::flush;
  }
  return begun;
}

void commit_scan(geometry::OutputFolder& folder, bool is_complete) {
  if (!is_complete && package::is_complete_result(folder.path() / scan_name)) {
    folder.move_to("interrupted");
  }
  folder.commit();
}

}  // namespace skycap::missions::verbs
