/// Flight behaviour for the content of a route file of any format.
#pragma once

#include <filesystem>
#include <string>

#include "flight/export/export.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Interprets route content. Missions are executed item by item. Formats for maps and setpoint
/// followers are lists of positions, flown in order. Throws Error{bad_file} with the first problem
/// of the format.
InterpretedRoute interpret(const std::string& content, Format format, const FlightFacts& facts);

/// Interprets a file. Errors include its name.
InterpretedRoute interpret_file(const std::filesystem::path& path, const FlightFacts& facts);

}  // namespace skycap::flight
