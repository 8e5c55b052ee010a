/// Verification of the returns from every point of a route file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/flight_options.h"

namespace skycap::missions::package {

struct ReturnCheck {
  bool is_safe = false;
  std::string text;  ///< One line of text for the user.
};

/// Verifies the returns of the autopilot that reads the file. The return altitude is taken from
/// `return_height`, the route file, or the parameter file in the same folder. If none specifies it,
/// the result contains the minimum verified altitude. Home is on the ground below the first point
/// of the route. Throws Error{bad_file} for an unreadable parameter file.
ReturnCheck check_returns(const std::filesystem::path& file,
                          const std::optional<double>& return_height,
                          const flight::FlightOptions& options, const flight::FreeSpace& space,
                          const std::vector<Eigen::Vector3d>& points);

}  // namespace skycap::missions::package
