/// Searches for take-off points near a target, according to the known obstacles of the site.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/clearance.h"
#include "flight/flight_options.h"

namespace skycap::missions::wizard {

class PadSearch {
 public:
  /// Uses the obstacles of the flight's airspace. Without terrain, the ground is at the airspace's
  /// base. `unknown` contains boxes around other targets in which unobserved space is occupied;
  /// climbs keep clear of them.
  explicit PadSearch(flight::FlightOptions flight, std::vector<Eigen::AlignedBox3d> unknown = {});

  /// Returns a pad on the ground outside an unknown box. The space above and near it is clear of
  /// known obstacles up to the height `top` (z) [m]. The nearest distance with enough space is
  /// selected, and there the position with the most space. Returns nullopt if no such position is
  /// within 100 m.
  std::optional<Eigen::Vector3d> find_pad_beside(const Eigen::AlignedBox3d& unknown,
                                                 double top) const;

  /// Returns the position on the ground below a map position, or nullopt if the terrain has no data
  /// there.
  std::optional<Eigen::Vector3d> at(const Eigen::Vector2d& position) const;

  /// Returns the clearance of the climb from a pad to `top` (z), up to `up_to` [m]. Returns 0 if
  /// the pad is invalid. The geofence is not considered, because it is extended around the pad
  /// later.
  double climb_clearance(const Eigen::Vector3d& pad, double top, double up_to) const;

 private:
  bool comes_near_unknown(const flight::Segment& climb) const;

  flight::FlightOptions flight_;
  std::vector<Eigen::AlignedBox3d> unknown_;
  flight::KnownSpace space_, pad_space_;
};

}  // namespace skycap::missions::wizard
