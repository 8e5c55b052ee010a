/// What the surveys of a district's targets have left behind.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "flight/route/pad_ground.h"
#include "flight/space/measured_space.h"
#include "geometry/place/pose.h"
#include "missions/batch/benchmark/trial_files.h"
#include "missions/batch/district/prepared.h"

namespace skycap::missions::batch {

/// A survey that is over.
struct SurveyFigures {
  std::filesystem::path folder;  ///< its package's
  std::size_t views = 0;
  double coverage = 0.0;                   ///< of the surface of the target's things
  std::optional<double> coverage_visible;  ///< of what can be seen of the scene
  double planning_time = 0.0;              ///< of all views [s] of a processor
  double time = 0.0;                       ///< of its own mission, flown by itself [s]
  double length = 0.0;                     ///< likewise [m]
  double wall_time = 0.0;                  ///< of the item [s]
  std::size_t peak_memory = 0;             ///< of the program until then [byte]
  std::size_t file_bytes = 0;              ///< of the package
  std::string stop_reason;
};

struct SurveyedTarget {
  PreparedTarget target;
  std::optional<SurveyFigures> figures;  ///< of a survey that is over
  std::string why_none;                  ///< else
};

/// The figures of a package in `folder`, whose survey ran as `record` says. Throws Error{bad_file}.
SurveyFigures figures_of(const std::filesystem::path& folder, const batch::TrialRecord& record);

/// What the flight of all needs of a package.
struct FlightInput {
  std::vector<geometry::View> views;
  std::vector<flight::PadGround> grounds;
  flight::MeasuredSpace measured;
};

/// Throws what package::read_package() throws.
FlightInput flight_input(const std::filesystem::path& folder);

}  // namespace skycap::missions::batch
