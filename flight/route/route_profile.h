/// Height, clearance and nearest obstacle along a route, for charts and tables.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/route/route.h"

namespace skycap::flight {

enum class ProfilePart { climb, leg, landing };

/// Straight piece of a route.
struct ProfilePiece {
  std::uint32_t sortie = 0;  ///< Index of the sortie.
  ProfilePart part = ProfilePart::leg;
  double begin = 0.0, end = 0.0;  ///< Distance flown since the first take-off [m].
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  /// Verified lower bound on the distance of the whole piece from the nearest obstacle [m], at most
  /// the route's clearance plus `reported_surplus`. Empty for climb and landing, which the pilot
  /// must check.
  std::optional<double> clearance;
  /// Nearest obstacle. Its kind is `none` beyond the search distance.
  Closest closest{0.0};
  std::string obstacle;  ///< Name of the nearest obstacle.

  /// Returns true if unobserved space limits the clearance.
  bool is_near_unknown() const { return closest.kind == ObstacleKind::unknown_space; }
};

/// Divides all sorties, flown with stops at every corner, into pieces of at most `step` [m], and
/// verifies each in `space`. The minimum clearance of the pieces is Route::min_clearance, because
/// the pieces cover all legs. The result is shorter if a stop is requested. Throws
/// Error{bad_config} unless the step is positive.
std::vector<ProfilePiece> route_profile(const Route& route, const FreeSpace& space, double step,
                                        const std::stop_token& stop = {});

}  // namespace skycap::flight
