/// What a vehicle does with a route file, stretch by stretch, and the proof that all of it is free.
///
/// Stretches are named by the two items that they lead between, numbered as ground stations show
/// them: `.waypoints` by the first field of a line, `.plan` by doJumpId, WPML by wpml:index,
/// counting from 0 in files without numbers of their own.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// A stretch: from some place of `start` straight to `to`. A vehicle that stops before it starts
/// at one place; one that is allowed to turn early starts anywhere between two.
struct FlownPiece {
  Segment start;
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  std::string from_item, to_item;  ///< such as "item 12"
  bool is_over_pad = false;        ///< of the climb or the landing, where the ground is no obstacle
  double hold = 0.0;               ///< waits at its end, as far as the file says them [s]
  double speed = not_given;        ///< over ground, where the file says [m/s]
};

/// A place where photographs are taken.
struct FlownStop {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::string item;
  double hold = 0.0;             ///< at rest before the first photograph [s]
  double yaw_deg = not_given;    ///< clockwise from north; not_given: nothing in the file says
  double pitch_deg = not_given;  ///< of the gimbal, 0 at the horizon
  int shots = 0;
};

struct FlownRoute {
  std::vector<FlownPiece> pieces;  ///< in the order flown
  std::vector<FlownStop> stops;    ///< those with photographs
  Problems problems;               ///< what is not known to be safe, or not known at all, by item
};

struct FlownProof {
  Problems problems;       ///< stretches that are not proven, by their items
  double clearance = 0.0;  ///< proven lower bound for all others, at most `up_to` [m]
};

/// Proves every stretch at `clearance`, looking at most `up_to` far; those over the pad in
/// `pad_space`, which should lack the ground there.
FlownProof prove(const FlownRoute& route, const FreeSpace& space, const FreeSpace& pad_space,
                 double clearance, double up_to);

/// Length of the stretches that are not over the pad [m].
double length(const FlownRoute& route);

}  // namespace skycap::flight
