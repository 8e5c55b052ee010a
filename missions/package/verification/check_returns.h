/// Whether a vehicle that flies a route file comes home safely from every point of it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/flight_options.h"
#include "flight/space/clearance.h"

namespace skycap::missions::package {

struct ReturnCheck {
  bool is_safe = false;
  std::string text;  ///< one line for the user
};

/// Proves the returns of the autopilot that reads the file, at the height of return that is given,
/// or that the file says, or the parameter file beside it; where none does, the least safe one is
/// looked for and said. Home is on the ground below the route's first point. Throws
/// Error{bad_file} for a parameter file that cannot be read.
ReturnCheck check_returns(const std::filesystem::path& file,
                          const std::optional<double>& return_height,
                          const flight::FlightOptions& options, const flight::FreeSpace& space,
                          const std::vector<Eigen::Vector3d>& points);

}  // namespace skycap::missions::package
