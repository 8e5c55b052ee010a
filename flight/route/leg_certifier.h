/// Proves the legs of a route, and says what they and the stops between them take.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/motion.h"
#include "flight/route/route.h"
#include "flight/route/sortie_split.h"
#include "flight/space/clearance.h"
#include "flight/way_home/ways_home.h"

namespace skycap::flight {

using LegCost = SplitProblem::Cost;

LegCost cost_of(const Leg& leg);
/// Of two parts, one after the other.
LegCost in_turn(const LegCost& first, const LegCost& second);

/// How many stations a sortie may have, by the mission items that its vehicle takes.
std::size_t most_stations(const Vehicle& vehicle);

/// Keeps references to all that it is constructed from.
class LegCertifier {
 public:
  /// With `ways_home`, which may be given later, costs count the return from the dearest point.
  LegCertifier(const FreeSpace& space, const Motion& motion, double clearance,
               const std::optional<WaysHome>& ways_home)
      : space_(space), motion_(motion), clearance_(clearance), ways_home_(ways_home) {}

  /// Along `points`, with a stop at each. From and to the pad, where there is nothing to aim at,
  /// the station is nullptr. Nothing if one of the lines cannot be proven.
  std::optional<Leg> leg(const std::vector<Eigen::Vector3d>& points, const Station* from,
                         const Station* to) const;

  /// A leg's time until the camera looks right.
  double aimed_time(double leg, const Station* from, const Station* to) const;

  LegCost takeoff_cost(double climb) const;
  LegCost landing_cost(double climb) const;
  LegCost station_cost(const Station& station) const;

 private:
  double return_cost(const Eigen::Vector3d& place) const;

  const FreeSpace& space_;
  const Motion& motion_;
  double clearance_;
  const std::optional<WaysHome>& ways_home_;
};

}  // namespace skycap::flight
