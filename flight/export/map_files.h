/// The flight for maps and globes: KML for Google Earth, GeoJSON for a GIS, CSV for Litchi.
#pragma once

#include <string>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// KML 2.2 with Google's track extension: the path, a point for each station, keep-out volumes, and
/// a track that plays the flight. Heights above mean sea level ("absolute"): needs the undulation.
std::string write_kml(const FlightPlan& plan);
Problems validate_kml(const std::string& text);
/// The places of the file's path (its LineString named "path").
RouteFile read_kml(const std::string& text);

/// GeoJSON (RFC 7946): ellipsoid heights; the path, the stations with their heights above every
/// known datum, the fence and the no-fly volumes.
std::string write_geojson(const FlightPlan& plan);
Problems validate_geojson(const std::string& text);
/// The places of the first LineString.
RouteFile read_geojson(const std::string& text);

/// Litchi Mission Hub's CSV: heights above take-off. Throws Error{bad_config} for more waypoints or
/// shots than the format holds. Its settings for the whole mission are not in the file; set heading
/// mode "Custom", path mode "Straight Lines".
std::string write_litchi(const FlightPlan& plan);
Problems validate_litchi(const std::string& text);
RouteFile read_litchi(const std::string& text);

}  // namespace skycap::flight
