/// Flight behaviour for a route file, piece by piece, with verification of all pieces.
///
/// Pieces are named by the two items that they connect, with the numbers that ground stations show.
/// These are the first field of a line in `.waypoints`, doJumpId in `.plan` and wpml:index in WPML.
/// Files without own numbers count from 0.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/export/flight_plan.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// Straight piece from a point of `start` to `to`. A vehicle that stops before has a single start
/// point. A vehicle that may turn early starts anywhere on the segment.
struct InterpretedSegment {
  Segment start;
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  std::string from_item, to_item;  ///< Item names, such as "item 12".
  bool is_over_pad = false;    ///< True for climb and landing, where the ground is not an obstacle.
  double hold = 0.0;           ///< Wait at the end, as specified in the file [s].
  double speed = unspecified;  ///< Ground speed, if specified in the file [m/s].
  double margin = 0.0;         ///< Maximum distance of the actual start from `start` [m].
  /// Distance over which the vehicle comes to rest if it is interrupted at the end of the piece
  /// [m]. Positive only at the corners that it passes.
  double braking = 0.0;
};

/// Position at which photos are taken.
struct InterpretedStop {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::string item;
  double hold = 0.0;  ///< Rest time before the first photo [s].
  double yaw_deg =
      unspecified;  ///< Clockwise from north. `unspecified`: not specified in the file.
  double pitch_deg = unspecified;  ///< Gimbal pitch, 0 at the horizon.
  int captures = 0;
  double hold_after = 0.0;  ///< Rest time after the first photo [s].
};

/// Photo taken in flight on a straight leg.
struct FlownPass {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::string item;                ///< Item at the end of the leg.
  double yaw_deg = unspecified;    ///< As in InterpretedStop.
  double pitch_deg = unspecified;  ///< As in InterpretedStop.
  double speed = unspecified;      ///< Ground speed, if specified in the file [m/s].
  double spacing = 0.0;          ///< Distance from the previous photo or the start of the leg [m].
  std::size_t stops_before = 0;  ///< Index of the next stop in InterpretedRoute::stops.
};

struct InterpretedRoute {
  std::vector<InterpretedSegment> segments;  ///< In flight order.
  std::vector<InterpretedStop> stops;        ///< Stops with photos.
  std::vector<FlownPass> is_fly_through;     ///< Photos taken in flight.
  Problems problems;                         ///< Unsafe or unknown behaviour, per item.
};

struct RouteVerification {
  Problems problems;       ///< Pieces that cannot be verified, with their items.
  double clearance = 0.0;  ///< Verified lower bound of all other pieces [m], at most `up_to`.
};

/// Verifies every piece at `clearance` [m], with a search distance of `up_to` [m]. Pieces above the
/// pad are verified in `pad_space`, which should not contain the ground there.
///
/// An interrupted vehicle, for example one that returns, brakes along its piece. Where it passes
/// the corner at the end, it may brake beyond it, in any direction between those of both pieces.
/// These paths are verified at the same clearance.
RouteVerification verify(const InterpretedRoute& route, const FreeSpace& space,
                         const FreeSpace& pad_space, double clearance, double up_to);

/// Possible start positions of a leg after a waypoint that is passed: within `margin` [m] of
/// `start`.
struct Departure {
  Segment start;
  double margin = 0.0;
};

/// Returns the departure from the end of `leg`, which the vehicle passes after it leaves the leg at
/// most `distance` [m] before. Where the leg itself starts beside its line, so does the departure,
/// but nearer to the line by the ratio of `distance` to its length.
Departure departure_after(const InterpretedSegment& leg, double distance);

/// Adds the photos of a distance trigger on the last straight leg of the route. One photo is at
/// each multiple of `spacing` [m] (positive) from the leg's start. Photos within half of that
/// distance from its end are not added, because the vehicle stops there.
void append_passes(InterpretedRoute& route, double spacing, double yaw_deg, double pitch_deg);

/// Returns the length of the pieces that are not above the pad [m].
double length(const InterpretedRoute& route);

}  // namespace skycap::flight
