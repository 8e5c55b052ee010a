/// The formats of route files: what they hold, writers and readers.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"

namespace skycap::flight {

enum class Format { plan, waypoints, kmz, kml, geojson, litchi, csv, ned_csv, tum };

/// A format's name on the command line, its file name's ending, and the datum its heights have.
struct FormatInfo {
  Format format;
  const char* name;
  const char* ending;
  const char* heights;
};
std::span<const FormatInfo> formats();
const FormatInfo& format_info(Format format);

/// The format of that name, such as "kmz". Throws Error{bad_usage} listing the names.
Format format_named(const std::string& name);

/// Whether files of this format can hold curved legs: those that are lists of places close to one
/// another. Of DJI's turn modes, which could also be told to round corners, it is not published
/// which curve is flown, so nothing could be proven of it.
bool holds_curves(Format format);

/// The content of the file, what it leaves out, and its problems.
std::string write(const FlightPlan& plan, Format format);
std::vector<std::string> notes_of(const FlightPlan& plan, Format format);
Problems validate(const std::string& content, Format format);

/// A file's places in the local frame, in the order of the file; `pad` is where heights above
/// take-off count from. Throws Error{bad_file} with the first problem. What a vehicle does with
/// them is interpreter/interpret.h's to say.
std::vector<Eigen::Vector3d> places_of(const std::string& content, Format format, const Site& site,
                                       const Eigen::Vector3d& pad);

inline constexpr std::size_t largest_route_file = std::size_t{64} << 20;

/// The format of a route file by its name's ending; .csv by its first line. Throws Error{bad_file}.
Format format_of_file(const std::filesystem::path& path, const std::string& content);

/// places_of() of a file of any format above, whoever wrote it. Errors name it.
std::vector<Eigen::Vector3d> read_route(const std::filesystem::path& path, const Site& site,
                                        const Eigen::Vector3d& pad);

/// How high above take-off the vehicle returns by that route file; nothing if it does not say.
std::optional<double> read_return_height(const std::filesystem::path& path);

/// Rounding moves a place by less than this: half of 1e-7 degrees each way and a centimetre up [m].
inline constexpr double rounding_bound = 0.02;

}  // namespace skycap::flight
