/// Export of flights with verification of the written file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "flight/clearance/clearance.h"
#include "flight/export/export.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Result of an export with notes for the user.
struct ExportResult {
  /// Verified clearance of the rounded file content [m], see LegVerification.
  double min_clearance = 0.0;
  std::vector<std::string> notes;
  std::vector<InterpretedStop> captures;  ///< where the file captures images, as read back
};

/// Writes the file under a temporary name, reads it back and interprets it like its target. The
/// interpreted flight is verified in `space` at the plan's clearance minus `rounding_bound`, and
/// only then the file is renamed to `path`. Throws Error{bad_geometry} if any step fails; an
/// existing file then remains unchanged.
ExportResult export_flight(const FlightPlan& plan, Format format, const FreeSpace& space,
                           const std::filesystem::path& path);

}  // namespace skycap::flight
