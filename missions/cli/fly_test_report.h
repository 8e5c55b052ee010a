/// What a test of flights found, for the user and as JSON.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "flight/fleet/fleet_flights.h"
#include "flight/fly_test/fly_test.h"

namespace skycap::missions::cli {

/// One route file and how its flights went.
struct TestedFile {
  std::string name;
  std::string autopilot;
  std::vector<flight::Judge> judges;
  flight::FlyTest test;
  double battery = 0.0;                ///< what it holds when full [J]
  std::vector<std::string> obstacles;  ///< by judge, what a flight came nearest to
};

/// Flights and returns that came nearer to anything than they may, and flights that the battery did
/// not last for.
std::size_t failures(const TestedFile& file);

/// Some lines for the user.
std::string text_of(const TestedFile& file);

nlohmann::ordered_json json_of(const TestedFile& file);

/// The same of a fleet that flew together.
std::string text_of(const flight::FleetFlightTest& test);
nlohmann::ordered_json json_of(const flight::FleetFlightTest& test);

}  // namespace skycap::missions::cli
