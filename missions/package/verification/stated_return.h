/// Return altitude of a vehicle as specified in its files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "flight/export/text.h"
#include "flight/motion/vehicle.h"

namespace skycap::missions::package {

/// Returns the autopilot for a route file, based on the file name. Returns an empty value for map
/// and set-point files.
std::optional<flight::AutopilotType> autopilot_for_file(const std::filesystem::path& file,
                                                        const flight::Vehicle& vehicle);

/// Return altitude above take-off [m] and its source.
struct StatedHeight {
  double height = 0.0;
  std::string by;
  flight::Problems problems;  ///< Settings that would change the return in other ways.
};

/// Returns the given altitude, or the one in the route file, or the one in the parameter file in
/// the same folder. Throws Error{bad_file} for an unreadable parameter file.
std::optional<StatedHeight> stated_height(const std::filesystem::path& route,
                                          const std::optional<double>& given,
                                          flight::AutopilotType autopilot);

}  // namespace skycap::missions::package
