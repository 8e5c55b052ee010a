/// What a vehicle does with the content of a route file of any format.
#pragma once

#include <filesystem>
#include <string>

#include "flight/export/export.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/flown_route.h"

namespace skycap::flight {

/// Missions are executed by their items; files for maps and set-point followers are lists of
/// places, flown one after the other. Throws Error{bad_file} with the first problem of the format.
FlownRoute interpret(const std::string& content, Format format, const FlightFacts& facts);

/// The same of a file. Errors name it.
FlownRoute interpret_file(const std::filesystem::path& path, const FlightFacts& facts);

}  // namespace skycap::flight
