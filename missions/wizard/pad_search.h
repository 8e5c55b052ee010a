/// Searches for take-off points near a target, according to the known obstacles of the site.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/clearance.h"
#include "flight/flight_options.h"

namespace skycap::missions::wizard {

/// Treatment of the geofence in a search. A proposal ignores it, because the geofence is extended
/// around the pad afterwards.
enum class PadFence { ignore, keep };

class PadSearch {
 public:
  /// Uses the obstacles of the flight's airspace. Without terrain, the ground is at the airspace's
  /// base. `unknown` contains boxes around other targets in which unobserved space is occupied;
  /// climbs keep clear of them.
  explicit PadSearch(flight::FlightOptions flight, std::vector<Eigen::AlignedBox3d> unknown = {},
                     PadFence fence = PadFence::ignore);

  /// On the ground beside an unknown box, with nothing known over it or near it up to `top` (z): as
  /// near as there is room, and there where most of it is. Views may be up to `view_reach` beside
  /// the box. For DJI's vehicles first where all of them are so far away that the vehicle climbs
  /// before it returns: nearer, each view also needs a free return at its own height. Nothing if
  /// nowhere within 100 m, and of such places within 200 m, is room.
  /// Without a `view_reach` that is not asked for.
  std::optional<Eigen::Vector3d> find_pad_beside(const Eigen::AlignedBox3d& unknown, double top,
                                                 std::optional<double> view_reach = {}) const;

  /// Returns the position on the ground below a map position, or nullopt if the terrain has no data
  /// there.
  std::optional<Eigen::Vector3d> at(const Eigen::Vector2d& position) const;

  /// Returns the clearance of the climb from a pad to `top` (z), up to `up_to` [m]. Returns 0 if
  /// the pad is invalid.
  double climb_clearance(const Eigen::Vector3d& pad, double top, double up_to) const;

 private:
  std::optional<Eigen::Vector3d> between(const Eigen::AlignedBox3d& unknown, double top,
                                         double first, double farthest) const;
  bool comes_near_unknown(const flight::Segment& climb) const;

  flight::FlightOptions flight_;
  std::vector<Eigen::AlignedBox3d> unknown_;
  flight::KnownSpace space_, pad_space_;
};

}  // namespace skycap::missions::wizard
