#include "missions/package/verification/check_returns.h"

#include <algorithm>

#include "flight/export/export.h"
#include "flight/rtl/min_return_altitude.h"
#include "missions/package/verification/stated_return.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using flight::AutopilotType;

std::string metres(double length) { return support::short_text(length) + " m"; }

}  // namespace

ReturnCheck check_returns(const std::filesystem::path& file,
                          const std::optional<double>& return_height,
                          const flight::FlightOptions& options, const flight::FreeSpace& space,
                          const std::vector<Vector3d>& points) {
  const std::optional<AutopilotType> autopilot =
      options.has_vehicle() ? autopilot_for_file(file, options.required_vehicle()) : std::nullopt;
  if (!autopilot || points.size() < 2) {
    return {true, "returns not checked: the file is not for an autopilot"};
  }
  std::vector<flight::Segment> legs;
  for (std::size_t i = 1; i < points.size(); ++i) legs.push_back({points[i - 1], points[i]});
  const double ground = options.pad(options.airspace.base).z();
  flight::RtlProfile rtl_profile{.autopilots = {*autopilot},
                                 .landings = {{points[0].x(), points[0].y(), ground}},
                                 .landing_climb = options.climb(),
                                 .braking = options.braking_before_return()};
  if (*autopilot != AutopilotType::dji) {
    const std::vector<Vector3d>& rally = options.rally;
    rtl_profile.landings.insert(rtl_profile.landings.end(), rally.begin(), rally.end());
  }
  const double clearance =
      std::max(0.0, flight::return_clearance(options.clearance) - flight::rounding_bound);

  const auto stated = stated_height(file, return_height, *autopilot);
  if (stated && !stated->problems.empty()) {
    return {false, "not verified: " + stated->by + ": " + stated->problems.front()};
  }
  std::string fault;
  if (stated) {
    rtl_profile.level = ground + stated->height;
    const flight::ReturnSearch verification = verify_returns(space, legs, rtl_profile, clearance);
    if (verification.found) {
      return {true, "all returns verified at " + metres(stated->height) + " (" + stated->by +
                        "), minimum clearance " + metres(verification.found->clearance)};
    }
    fault = "not verified: at " + metres(stated->height) + " (" + stated->by + ") " +
            verification.reason + "; ";
  }
  const double top = space.extent().isEmpty() ? ground : space.extent().max().z();
  const flight::ReturnSearch min = min_return_altitude(
      space, legs, rtl_profile, options.max_return_altitude(ground, top), clearance);
  if (!min.found) {
    return {false, fault.empty()
                       ? "not verified: no return altitude keeps the clearance: " + min.reason
                       : fault + " no other altitude can be verified"};
  }
  const std::string needed = metres(min.found->height);
  if (!fault.empty()) return {false, fault + "the lowest verified return altitude is " + needed};
  return {true, "the file does not contain the vehicle's return altitude: set it to " + needed +
                    " above take-off, the lowest verified altitude"};
}

}  // namespace skycap::missions::package
