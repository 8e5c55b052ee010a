#include "flight/interpreter/home_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace skycap::flight {

using Eigen::Vector3d;

Problems check_home(const MavlinkMission& file, const std::optional<Vector3d>& pad,
                    const FlightFacts& facts) {
  if (!file.home) return {};
  if (!facts.site.geoid_undulation) {
    return {file.home_name +
            " is a height above mean sea level; set site.geoid_undulation to compare it with the "
            "take-off point"};
  }
  Problems problems;
  GeodeticPoint home = *file.home;
  home.height += *facts.site.geoid_undulation;
  const Vector3d away = LocalFrame(facts.site.origin).to_local(home) - pad.value_or(facts.pad);
  const double level = away.head<2>().norm();
  if (level > pad_tolerance && (pad || facts.is_pad_known)) {
    problems.push_back(file.home_name + " is " + fixed(level, 1) + " m from the take-off point");
  }
  if (std::abs(away.z()) > pad_height_tolerance) {
    problems.push_back(file.home_name + " is " + fixed(std::abs(away.z()), 1) + " m " +
                       (away.z() > 0.0 ? "above" : "below") + " the take-off point");
  }
  return problems;
}

Problems check_rally(const MavlinkMission& file, const FlightFacts& facts) {
  Problems problems;
  const LocalFrame frame(facts.site.origin);
  std::vector<Vector3d> missing = facts.rally;
  for (std::size_t i = 0; i < file.rally.size(); ++i) {
    const std::string name = "rallyPoints.points[" + std::to_string(i) + "]";
    const Vector3d position = frame.to_local(file.rally[i]);
    const auto known = std::ranges::find_if(missing, [&](const Vector3d& rally) {
      return (rally - position).head<2>().norm() <= pad_tolerance;
    });
    if (known == missing.end()) {
      problems.push_back(name +
                         " is not in the mission's flight.rally: returns to it are not verified");
      continue;
    }
    missing.erase(known);
    if (std::abs(file.rally[i].height) <= pad_height_tolerance) continue;
    problems.push_back(
        name + " is " + fixed(file.rally[i].height, 1) +
        " m above home; it must be at 0 m, because PX4 raises its returns by this height");
  }
  if (missing.empty()) return problems;
  problems.push_back("the file does not contain " + std::to_string(missing.size()) +
                     " of the mission's " + std::to_string(facts.rally.size()) +
                     " rally points that are used for verified returns");
  return problems;
}

}  // namespace skycap::flight
