/// Writes flights so that what is on disk is what was proved.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "flight/export/export.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// What an export leaves unsaid or undone, for the user to read.
struct ExportResult {
  double min_clearance = 0.0;  ///< proven for the file as read back and rounded [m], see LegProof
  std::vector<std::string> notes;
};

/// Writes the file under a temporary name, reads it back, interprets it as its target would fly it,
/// and proves that in `space` again, at the plan's clearance less `rounding_bound`; only then it
/// gets its name. Throws Error{bad_geometry} if any of that fails: the name then stays as it was.
ExportResult export_flight(const FlightPlan& plan, Format format, const FreeSpace& space,
                           const std::filesystem::path& path);

}  // namespace skycap::flight
