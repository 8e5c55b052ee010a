/// How high a vehicle returns that flies a route file, as far as the files say.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "flight/export/text.h"
#include "flight/motion/vehicle.h"

namespace skycap::missions::package {

/// The autopilot that flies such a file, by its name; nobody by itself if it is for maps or
/// set-point followers.
std::optional<flight::Dialect> dialect_of(const std::filesystem::path& file,
                                          const flight::Vehicle& vehicle);

/// A height of return above take-off, and who says so.
struct StatedHeight {
  double height = 0.0;
  std::string by;
  flight::Problems problems;  ///< settings by which the vehicle would return in another way
};

/// The height that is given, or that the route file says, or the parameter file beside it. Throws
/// Error{bad_file} for a parameter file that cannot be read.
std::optional<StatedHeight> stated_height(const std::filesystem::path& route,
                                          const std::optional<double>& given,
                                          flight::Dialect dialect);

}  // namespace skycap::missions::package
