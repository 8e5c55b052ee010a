/// Flight behaviour for the content of a route file of any format.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "flight/export/export.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Interprets route content. Missions are executed item by item. Formats for maps and setpoint
/// followers are lists of positions, flown in order. Throws Error{bad_file} with the first problem
/// of the format.
InterpretedRoute interpret(const std::string& content, Format format, const FlightFacts& facts);

/// Where a file that is flown like that captures images: the stops of missions, and the rows of a
/// trajectory that are marked so. Empty for KML, GeoJSON and TUM, which command no camera.
std::vector<InterpretedStop> list_captures(const std::string& content, Format format,
                                           const InterpretedRoute& route);

/// interpret() of a file. Errors name it.
InterpretedRoute interpret_file(const std::filesystem::path& path, const FlightFacts& facts);

}  // namespace skycap::flight
