/// DJI waypoint missions for Pilot 2 and FlightHub 2: a zip archive with two KML files in the WPML
/// vocabulary. The apps show and edit `template.kml`; the aircraft flies `waylines.wpml`. Both
/// files are written with equivalent content.
///
/// Source: DJI Cloud API documentation, chapter DJI WPML.
#pragma once

#include <string>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// Returns the bytes of a .kmz file. Heights are above take-off; legs are straight with a stop at
/// every point. Throws Error{bad_config} for vehicles other than DJI's, or if the vehicle's
/// waypoint limit is exceeded.
std::string write_kmz(const FlightPlan& plan);

/// Returns the problems of a .kmz file with file and element names, empty if it is valid.
Problems validate_kmz(const std::string& bytes);

/// Content of the two files in the archive, for inspection. Members are identified by file name in
/// any folder. unpack_kmz() throws Error{bad_file} if the waylines are missing or a name is
/// duplicate.
struct KmzContent {
  /// Empty: the archive has no template, so the mission cannot be edited.
  std::string template_kml;
  std::string waylines_wpml;
};
KmzContent unpack_kmz(const std::string& bytes);

/// Inverse of unpack_kmz(). Deterministic: equal content gives equal bytes.
std::string pack_kmz(const KmzContent& content);

/// Reads the positions of the waylines. Throws Error{bad_file} with the first problem.
RouteFile read_kmz(const std::string& bytes);
RouteFile read_kmz(const KmzContent& content);

}  // namespace skycap::flight
