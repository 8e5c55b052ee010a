/// Coverage of the written route files, by a simulated re-flight of each file. It differs from the
/// survey's coverage: views may have no verified return, and a format may fly past views at which
/// another one stops.
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

/// Coverage of all sorties in the files of one or more formats with identical captures.
struct WrittenCoverage {
  std::vector<std::string> files;  ///< File names.
  std::size_t views = 0;   ///< Captured views, or passed views if the scanner measures in flight.
  ReflightCoverage again;  ///< Result of the re-flight, starting with an empty cloud.
  std::vector<TargetCoverage> targets;  ///< Result of target_coverage().
  MissingSurface missing;               ///< Uncovered surface according to the simulator.
  std::vector<std::uint8_t>
      is_covered{};  ///< 1 for each covered sample of the surface, otherwise 0.
};

struct WrittenMission {
  std::size_t planned = 0;  ///< Number of views of the survey, or of the replanned mission.
  std::vector<WrittenCoverage> parts;
};

/// Returns the views captured by the written files of a format, in flight order. Captures have the
/// poses read from the files. A view without a capture in the files is not contained. If the format
/// has no camera commands, all views of the route are assumed captured. Scanners are assumed to
/// measure along the whole route.
std::vector<session::ViewInFlight> written_views(const flight::FlightOptions& options,
                                                 const flight::Route& route,
                                                 const FlightFiles& files, flight::Format format);

/// Returns the coverage of the files of the mission and of its fleet. Returns null if the views
/// cannot be simulated again, if no file was written, or after a stop request through `stop`.
std::shared_ptr<const WrittenMission> written_mission(
    const evaluation::SimulationOptions& simulation, const CoverageFigures& coverage,
    const SurveyMission& mission, const std::stop_token& stop);

/// Returns the content of `flight.written` in summary.json.
nlohmann::ordered_json written_json(const WrittenMission& mission);

/// Returns the lines that the program prints.
std::string written_text(const WrittenMission& mission);

}  // namespace skycap::missions::package
