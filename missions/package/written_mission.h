/// What the written route files cover, by a simulated re-flight of what each of them says. The
/// survey's own coverage differs: views may have no verified return, and a format may fly past
/// views that another one stops at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "flight/flight_options.h"
#include "missions/package/flight_files.h"
#include "missions/package/holes.h"
#include "missions/package/package.h"
#include "missions/package/target_coverage.h"
#include "missions/scene/scene_options.h"
#include "missions/session/view_in_flight.h"

namespace skycap::missions::package {

/// Of the files of one or more formats, which capture the same: their sorties together.
struct WrittenCoverage {
  std::vector<std::string> files;          ///< names
  std::size_t views = 0;                   ///< that they capture; of a scanner in flight: pass
  ReflightCoverage again;                  ///< from an empty cloud
  std::vector<TargetCoverage> targets;     ///< as target_coverage()
  MissingSurface missing;                  ///< as the simulator knows the surface
  std::vector<std::uint8_t> is_covered{};  ///< 1 for each covered sample of the surface
};

struct WrittenMission {
  std::size_t planned = 0;  ///< views of the survey, or the replanned ones
  std::vector<WrittenCoverage> parts;
};

/// What the written files of a format measure, in the order flown. Poses of captures are those that
/// were read back from the files; a view that no file captures is not among them. Formats that
/// command no camera are taken to capture at the route's views, scanners to measure all the way.
std::vector<session::ViewInFlight> written_views(const flight::FlightOptions& options,
                                                 const flight::Route& route,
                                                 const FlightFiles& files, flight::Format format);

/// Of the mission's files, and of its fleet's; null where views cannot be flown again, where there
/// is no file, or once `stop` is requested.
std::shared_ptr<const WrittenMission> written_mission(
    const evaluation::SimulationOptions& simulation, const CoverageFigures& coverage,
    const SurveyMission& mission, const std::stop_token& stop);

/// `flight.written` of the summary.
nlohmann::ordered_json written_json(const WrittenMission& mission);

/// What the program prints.
std::string written_text(const WrittenMission& mission);

}  // namespace skycap::missions::package
