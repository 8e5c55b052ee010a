/// Writes flights so that what is on disk is what was proved.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"
#include "flight/space/clearance.h"

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

/// The content of the file, its problems, and its places as a route.
std::string write(const FlightPlan& plan, Format format);
Problems validate(const std::string& content, Format format);
/// Places in the local frame as the target would fly them: rounded as its memory rounds.
std::vector<Eigen::Vector3d> flown_points(const std::string& content, Format format,
                                          const FlightPlan& plan);

/// The format of a route file by its name's ending; .csv by its first line. Throws Error{bad_file}.
Format format_of_file(const std::filesystem::path& path, const std::string& content);

/// A route file's places in the local frame: any format above, whoever wrote it. `pad` is where
/// heights above take-off count from. Throws Error{bad_file} naming the file and its first problem.
std::vector<Eigen::Vector3d> read_route(const std::filesystem::path& path, const Site& site,
                                        const Eigen::Vector3d& pad);

/// How high above take-off the vehicle returns by that route file; nothing if it does not say.
std::optional<double> read_return_height(const std::filesystem::path& path);

/// What an export leaves unsaid or undone, for the user to read.
struct ExportResult {
  double min_clearance = 0.0;  ///< proven for the file as read back and rounded [m], see LegProof
  std::vector<std::string> notes;
};

/// Rounding moves a place by less than this: half of 1e-7 degrees each way and a centimetre up [m].
inline constexpr double rounding_bound = 0.02;

/// Writes the file under a temporary name, reads it back, rounds it as its target would, validates
/// it and proves its legs in `space` again, at the plan's clearance less `rounding_bound`; only
/// then it gets its name. Throws Error{bad_file} if any of that fails: the name then stays as it
/// was.
ExportResult export_flight(const FlightPlan& plan, Format format, const FreeSpace& space,
                           const std::filesystem::path& path);

}  // namespace skycap::flight
