/// Table of the height, the clearance and the nearest obstacle along a route: profile.csv.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "flight/clearance/clearance.h"
#include "flight/flight_options.h"
#include "flight/route/route_profile.h"
#include "geometry/io/output_folder.h"

namespace skycap::missions::package {

inline constexpr const char* profile_name = "profile.csv";

/// Returns the profile of a route in `measured` space and the airspace rules of `options`, in
/// pieces of 1 m, or longer for routes above 2 km.
std::vector<flight::ProfilePiece> make_profile(const flight::FlightOptions& options,
                                               const flight::Route& route,
                                               const flight::FreeSpace& measured,
                                               const std::stop_token& stop = {});

/// Returns the content of profile.csv (docs/reference/results.md).
std::string profile_csv(const std::vector<flight::ProfilePiece>& pieces,
                        const flight::FlightOptions& options, const flight::Route& route);

/// Stages profile.csv. Does nothing for a route without a sortie, or after a stop request.
void stage_profile(const flight::FlightOptions& options, const flight::Route& route,
                   const flight::FreeSpace& measured, geometry::OutputFolder& folder,
                   const std::stop_token& stop = {});

/// Row of profile.csv, for the report.
struct ProfileRow {
  std::string part{};              ///< "climb", "leg" or "landing".
  double begin = 0.0, end = 0.0;   ///< Distance flown [m].
  double height = 0.0;             ///< Above the take-off point, at the end [m].
  double ground = 0.0;             ///< Height of the ground there [m].
  bool is_terrain = false;         ///< The ground is known, not assumed.
  double clearance = 0.0;          ///< 0 where it is not verified [m].
  double required = 0.0;           ///< Required clearance [m].
  std::string kind{}, obstacle{};  ///< Kind and name of the nearest obstacle.
};

/// Reads profile.csv. Throws Error{bad_file} with the line of the first invalid row.
std::vector<ProfileRow> read_profile(const std::string& text);

}  // namespace skycap::missions::package
