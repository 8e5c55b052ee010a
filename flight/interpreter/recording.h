/// Verification that the legs of a file are recorded by a laser scanner in the planned directions.
#pragma once

#include <span>
#include <string>

#include <Eigen/Core>

#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Leg between two waypoints, as a vehicle with a scanner flies it according to the file.
struct ScannedLeg {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  std::string from_item, to_item;
  double speed = unspecified;  ///< Ground speed [m/s].
  bool is_recorded = false;
  double yaw_from_deg = unspecified;  ///< Heading at the start, clockwise from north.
  double yaw_deg =
      unspecified;  ///< Heading at the end. The heading changes linearly along the leg.
  double pitch_deg = unspecified;  ///< Gimbal pitch, constant along the leg.
};

/// Returns the problems of the legs by item: legs that are not recorded, have another speed than
/// the mission, or have another scanner direction than the mission's views. The comparison at both
/// ends covers the whole leg, because headings change linearly and pitches are constant. Legs of an
/// IMU calibration, back and forth at the ends of the route, are skipped. Returns no problems if
/// the vehicle has no scanner that files can command.
Problems check_recording(std::span<const ScannedLeg> legs, const FlightFacts& facts);

}  // namespace skycap::flight
