/// What the legs of a route and the stops between them take.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "flight/motion/motion.h"
#include "flight/route/leg_planner.h"
#include "flight/route/route.h"
#include "flight/route/sortie_split.h"
#include "flight/way_home/ways_home.h"

namespace skycap::flight {

using LegCost = SplitProblem::Cost;

LegCost cost_of(const Leg& leg);
/// Of two parts, one after the other.
LegCost in_turn(const LegCost& first, const LegCost& second);

/// How many stations a sortie may have, by the mission items that its vehicle takes.
std::size_t most_stations(const Vehicle& vehicle);

/// Keeps references to all that it is constructed from.
class LegCosts {
 public:
  /// With `returns`, which may be required later, costs count the return from the dearest point.
  explicit LegCosts(const Motion& motion, const std::optional<WaysHome>* returns = nullptr)
      : motion_(motion), returns_(returns) {}

  /// Along a path, with a stop at each point. From and to the pad, where there is nothing to aim
  /// at, the station is nullptr.
  Leg leg(VerifiedPath path, const Station* from, const Station* to) const;

  /// A leg's time until the camera looks right.
  double aimed_time(double leg, const Station* from, const Station* to) const;

  LegCost takeoff_cost(double climb) const;
  LegCost landing_cost(double climb) const;
  LegCost station_cost(const Station& station) const;

 private:
  double return_cost(const Eigen::Vector3d& place) const;

  const Motion& motion_;
  const std::optional<WaysHome>* returns_;
};

}  // namespace skycap::flight
