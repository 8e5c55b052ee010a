/// Flight files for maps and globes: KML for Google Earth, GeoJSON for GIS, CSV for Litchi.
#pragma once

#include <string>
#include <vector>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// Returns KML 2.2 with Google's track extension: path, one point per waypoint, no-fly volumes, and
/// a track that replays the flight. Heights are AMSL ("absolute"), which requires the geoid
/// undulation.
std::string write_kml(const FlightPlan& plan);
Problems validate_kml(const std::string& text);
/// Reads the positions of the LineString named "path".
RouteFile read_kml(const std::string& text);

/// Returns GeoJSON (RFC 7946) with ellipsoid heights: path, fence, no-fly volumes, and waypoints
/// with their heights in every known datum.
std::string write_geojson(const FlightPlan& plan);
Problems validate_geojson(const std::string& text);
/// Reads the positions of the first LineString.
RouteFile read_geojson(const std::string& text);

/// Returns Litchi Mission Hub CSV with heights above take-off. The file does not contain
/// mission-wide settings: the user must set heading mode "Custom" and path mode "Straight Lines".
/// Throws Error{bad_config} if the format cannot hold that many waypoints or captures.
std::string write_litchi(const FlightPlan& plan);
/// The plan in parts of at most 99 waypoints. Each begins where the one before ends, with a stop
/// that captures nothing.
std::vector<FlightPlan> litchi_parts(const FlightPlan& plan);
Problems validate_litchi(const std::string& text);
RouteFile read_litchi(const std::string& text);

}  // namespace skycap::flight
