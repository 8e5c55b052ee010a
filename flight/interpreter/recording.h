/// Whether a laser scanner records all that its mission wants, and looks there.
#pragma once

#include <span>
#include <string>

#include <Eigen/Core>

#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// A leg between two waypoints as a file makes a vehicle with a scanner fly it.
struct ScannedLeg {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  std::string from_item, to_item;
  double speed = unspecified;  ///< over ground [m/s]
  bool is_recorded = false;
  double yaw_from_deg = unspecified;  ///< heading at its start, clockwise from north
  double yaw_deg = unspecified;       ///< heading at its end; it turns evenly between them
  double pitch_deg = unspecified;     ///< of the gimbal, on all of it
};

/// Legs that are not recorded, are flown at another speed than the mission's, or on which the
/// scanner looks elsewhere than the mission's views, by item: at every moment, since headings turn
/// evenly on the last leg before a view and pitches do not change. Legs of an IMU calibration, back
/// and forth at the ends of the route, are left out. Nothing where facts.vehicle carries no scanner
/// that files command.
Problems check_recording(std::span<const ScannedLeg> legs, const FlightFacts& facts);

}  // namespace skycap::flight
