/// Reports of flight tests as text and JSON.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "flight/fleet/fleet_flights.h"
#include "flight/monte_carlo/monte_carlo.h"

namespace skycap::missions::cli {

/// Results of the flight test of one route file.
struct TestedFile {
  std::string name;
  std::string autopilot;
  std::vector<flight::ClearanceCriterion> criteria;
  flight::FlyTest test;
  double battery = 0.0;                ///< energy of the full battery [J]
  std::vector<std::string> obstacles;  ///< name of the nearest obstacle, by judge
};

/// Returns the number of flights and returns that violate the clearance or exceed the battery's
/// energy.
std::size_t failures(const TestedFile& file);

/// Returns a summary of several lines.
std::string format_report(const TestedFile& file);

nlohmann::ordered_json to_json(const TestedFile& file);

/// Return the reports of a joint fleet flight.
std::string format_report(const flight::FleetFlightTest& test);
nlohmann::ordered_json to_json(const flight::FleetFlightTest& test);

}  // namespace skycap::missions::cli
