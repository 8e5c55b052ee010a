#include "missions/package/verification/check_returns.h"

#include <algorithm>

#include "flight/export/export.h"
#include "flight/way_home/least_return.h"
#include "missions/package/verification/stated_return.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using flight::Dialect;

std::string metres(double length) { return support::short_text(length) + " m"; }

}  // namespace

ReturnCheck check_returns(const std::filesystem::path& file,
                          const std::optional<double>& return_height,
                          const flight::FlightOptions& options, const flight::FreeSpace& space,
                          const std::vector<Vector3d>& points) {
  const std::optional<Dialect> dialect =
      options.is_flown() ? dialect_of(file, options.flown()) : std::nullopt;
  if (!dialect || points.size() < 2) {
    return {true, "returns not checked: no autopilot returns by this file"};
  }
  std::vector<flight::Segment> legs;
  for (std::size_t i = 1; i < points.size(); ++i) legs.push_back({points[i - 1], points[i]});
  const double ground = options.pad(options.airspace.base).z();
  flight::ReturnLaw law{.dialects = {*dialect},
                        .landings = {{points[0].x(), points[0].y(), ground}},
                        .landing_climb = options.climb()};
  if (*dialect != Dialect::dji) {
    const std::vector<Vector3d>& rally = options.rally;
    law.landings.insert(law.landings.end(), rally.begin(), rally.end());
  }
  const double clearance =
      std::max(0.0, flight::return_clearance(options.clearance) - flight::rounding_bound);

  const auto stated = stated_height(file, return_height, *dialect);
  if (stated && !stated->problems.empty()) {
    return {false, "not safe, " + stated->by + ": " + stated->problems.front()};
  }
  std::string fault;
  if (stated) {
    law.level = ground + stated->height;
    const flight::ReturnSearch proof = prove_returns(space, legs, law, clearance);
    if (proof.found) {
      return {true, "all returns verified at " + metres(stated->height) + " (" + stated->by +
                        "), minimum clearance " + metres(proof.found->clearance)};
    }
    fault = "not safe, at " + metres(stated->height) + " (" + stated->by + ") " + proof.why + "; ";
  }
  const double top = space.extent().isEmpty() ? ground : space.extent().max().z();
  const flight::ReturnSearch least =
      least_return(space, legs, law, options.highest_return(ground, top), clearance);
  if (!least.found) {
    return {false, fault.empty() ? "not safe, no return altitude is: " + least.why
                                 : fault + " no other altitude is safe"};
  }
  const std::string needed = metres(least.found->height);
  if (!fault.empty()) return {false, fault + "the lowest safe return altitude is " + needed};
  return {true, "the file does not contain the vehicle's return altitude: set it to " + needed +
                    " above take-off, the lowest verified one"};
}

}  // namespace skycap::missions::package
