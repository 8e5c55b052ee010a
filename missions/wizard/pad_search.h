/// Where a vehicle may take off and land beside a target, by all that is known of the site.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/flight_options.h"
#include "flight/space/clearance.h"

namespace skycap::missions::wizard {

class PadSearch {
 public:
  /// Of the flight's airspace, whose prior data is what the files hold; where there is no terrain
  /// its base is the ground. `unknown` are boxes in which nothing is free before it
  /// is measured, those of other targets: no climb comes near them.
  explicit PadSearch(flight::FlightOptions flight, std::vector<Eigen::AlignedBox3d> unknown = {});

  /// On the ground beside an unknown box, with nothing known over it or near it up to `top` (z): as
  /// near as there is room, and there where most of it is; nothing within 100 m has room.
  std::optional<Eigen::Vector3d> beside(const Eigen::AlignedBox3d& unknown, double top) const;

  /// On the ground at a place of the map; nothing where the terrain's files have none.
  std::optional<Eigen::Vector3d> at(const Eigen::Vector2d& place) const;

  /// How near the climb from a pad to `top` comes to what stands beside it, up to `up_to`; 0 if the
  /// pad is not one. The fence is put around the pad afterwards.
  double room_over(const Eigen::Vector3d& pad, double top, double up_to) const;

 private:
  bool comes_near_unknown(const flight::Segment& climb) const;

  flight::FlightOptions flight_;
  std::vector<Eigen::AlignedBox3d> unknown_;
  flight::KnownSpace space_, pad_space_;
};

}  // namespace skycap::missions::wizard
