/// DJI's waypoint missions: a zip of two KML files in the WPML vocabulary, read by Pilot 2 and
/// FlightHub 2. `template.kml` is what they show and edit, `waylines.wpml` what the aircraft flies;
/// both are written, and agree.
///
/// Source: DJI Cloud API documentation, chapter DJI WPML.
#pragma once

#include <string>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// The bytes of a .kmz file. Heights are above take-off; legs are straight, with a stop at every
/// point. Throws Error{bad_config} for a vehicle that is not DJI's, or if there are more waypoints
/// than the vehicle takes.
std::string write_kmz(const FlightPlan& plan);

/// What is wrong with a .kmz file, naming file and element; empty when it is good.
Problems validate_kmz(const std::string& bytes);

/// The two files inside, for inspection. Members are found by their last names, whatever folder
/// they are in. Throws Error{bad_file} if the archive lacks the waylines or holds two of a name.
struct KmzContent {
  std::string template_kml;  ///< empty: the archive lacks it, and the mission cannot be edited
  std::string waylines_wpml;
};
KmzContent unpack_kmz(const std::string& bytes);

/// The inverse of unpack_kmz(); the same content gives the same bytes.
std::string pack_kmz(const KmzContent& content);

/// The waylines' places. Throws Error{bad_file} with the first problem.
RouteFile read_kmz(const std::string& bytes);
RouteFile read_kmz(const KmzContent& content);

}  // namespace skycap::flight
