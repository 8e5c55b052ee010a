/// Route file formats with their writers and readers.
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

/// Format with its command-line name, file extension and altitude reference.
struct FormatInfo {
  Format format;
  const char* name;
  const char* extension;
  const char* heights;
};
std::span<const FormatInfo> formats();
const FormatInfo& format_info(Format format);

/// Returns the format of that name, such as "kmz". Throws Error{bad_usage} with the list of names.
Format format_named(const std::string& name);

/// Returns true if files of this format can hold curved legs, as lists of closely spaced positions.
/// DJI's turn modes round corners, too, but the exact curves are unpublished and cannot be
/// verified.
bool supports_curves(Format format);

/// Whether positions are in the local frame, so that files of this format need no georeference.
bool is_local(Format format);

/// Whether files of this format capture an image at each view.
bool captures_images(Format format);

/// Whether files of this format can trigger a camera at even distances (photo_runs.h).
bool holds_photo_runs(Format format);

/// The plan as files of this format hold it: one plan, or several to be flown one after the other
/// in one flight, each from the last waypoint of the one before.
std::vector<FlightPlan> split_plan(const FlightPlan& plan, Format format);

/// Returns the file content, the notes on omitted data, or the problems of the content.
std::string write(const FlightPlan& plan, Format format);
std::vector<std::string> make_notes(const FlightPlan& plan, Format format);
Problems validate(const std::string& content, Format format);

/// Returns the positions of a file in the local frame [m], in file order. `pad` is the altitude
/// reference for heights above take-off. Throws Error{bad_file} with the first problem. For the
/// vehicle's behaviour see interpreter/interpret.h.
std::vector<Eigen::Vector3d> read_positions(const std::string& content, Format format,
                                            const Site& site, const Eigen::Vector3d& pad);

inline constexpr std::size_t largest_route_file = std::size_t{64} << 20;

/// Returns the format for a file extension; for .csv the first line decides. Throws
/// Error{bad_file}.
Format detect_format(const std::filesystem::path& path, const std::string& content);

/// Returns read_positions() for a file of any supported format and origin. Errors include the file
/// name.
std::vector<Eigen::Vector3d> read_route(const std::filesystem::path& path, const Site& site,
                                        const Eigen::Vector3d& pad);

/// Returns the return altitude above take-off that a route file specifies [m], or std::nullopt.
std::optional<double> read_return_height(const std::filesystem::path& path);

/// Upper bound on the displacement by rounding [m]: half of 1e-7 degrees horizontally and 1 cm
/// vertically.
inline constexpr double rounding_bound = 0.02;

}  // namespace skycap::flight
