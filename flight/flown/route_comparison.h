/// Comparison of a flown track with a planned route: deviation and duration of each leg, legs that
/// were not flown, and captures that were made or missed.
///
/// Method: the planned path is divided into pieces. A monotone alignment assigns each position of
/// the track to a piece. It minimises the sum of squared distances by dynamic programming, as in
/// dynamic time warping (Sakoe and Chiba, 1978). Pieces may be skipped at a small cost, and
/// distances beyond the maximum deviation have a constant cost. Detours and omitted legs therefore
/// do not distort the assignment of the rest. Captures are aligned in the same manner, by position
/// and viewing direction.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/flown/flown_track.h"
#include "flight/interpreter/interpreted_route.h"
#include "flight/motion/motion.h"

namespace skycap::flight {

/// Planned path between two captures, or between items of a route without captures.
struct PlannedLeg {
  std::vector<Eigen::Vector3d> points;  ///< At least one point.
  double duration = 0.0;                ///< Including the stop at its end [s].
  std::string from, to;                 ///< Items of the route file, such as "item 12".
};

/// Planned photo or scan.
struct PlannedCapture {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double yaw_deg = unspecified;    ///< Clockwise from north.
  double pitch_deg = unspecified;  ///< 0 at the horizon.
  std::string item;                ///< Item of the route file.
};

struct PlannedFlight {
  std::vector<PlannedLeg> legs;
  std::vector<PlannedCapture> captures;  ///< In flight order.
};

/// Returns the legs and captures of a route file with the vehicle of `motion`.
PlannedFlight make_planned_flight(const InterpretedRoute& route, const Motion& motion);

/// Appends the flight of the next sortie.
void append_flight(PlannedFlight& flight, PlannedFlight next);

struct ComparisonOptions {
  /// Maximum distance of a flown position from the plan at which it counts as flown [m].
  double max_deviation = 3.0;

  /// Throws Error{bad_config} unless the deviation is positive and finite.
  void validate() const;
};

/// Flown counterpart of a leg.
struct LegComparison {
  double flown_fraction = 0.0;  ///< Fraction of its length with a flown position.
  /// At least half of the leg was flown. The following values are 0 otherwise.
  bool is_flown = false;
  double max_error = 0.0;   ///< Maximum distance of the track from the leg [m].
  double mean_error = 0.0;  ///< Mean distance, weighted by flown length [m].
  double begin = 0.0;       ///< Time of departure [s].
  double duration = 0.0;    ///< Including the stop at its end [s].
};

/// Flown counterpart of a planned capture.
struct CaptureComparison {
  bool is_made = false;
  /// State at the capture. The camera's direction is the planned one where the log has none.
  TrackState state;
  double error = 0.0;  ///< Distance from the planned position [m].
  /// Angle between the planned and the logged viewing direction [rad]. Empty if it is not logged.
  std::optional<double> turned;
};

struct RouteComparison {
  std::vector<LegComparison> legs;          ///< One for each planned leg.
  std::vector<CaptureComparison> captures;  ///< One for each planned capture.
  std::vector<TrackState> other_captures;   ///< Captures without a plan, with a known direction.
  std::size_t num_other_captures = 0;       ///< Number of captures without a plan.
  /// True if the log has no camera events: captures are assumed at each stop that was reached.
  bool are_captures_assumed = false;
  double duration = 0.0;  ///< Flown time without the time between flights [s].
  double length = 0.0;    ///< Flown length [m].
  /// Mean displacement of the captures from their planned positions: east, north, up [m].
  Eigen::Vector3d mean_offset = Eigen::Vector3d::Zero();
};

/// Returns the length, duration and captures of a flight without a plan.
RouteComparison measure_flight(const FlownTrack& track);

/// Compares a track with the plan. Throws the errors of ComparisonOptions::validate().
RouteComparison compare_route(const PlannedFlight& plan, const FlownTrack& track,
                              const ComparisonOptions& options);

}  // namespace skycap::flight
