/// Coverage maps for the customer on site: covered surface, missing surface, and the reasons.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "geometry/io/cloud_io.h"
#include "geometry/surfaces/mesh.h"
#include "survey/surfel/surfel_planner.h"

namespace skycap::missions::package {

/// Returns a point with normal and colour for each known or predicted surface patch:
///
///     green   covered (darker for higher probability);
///     amber   observed, but undersampled for the noise;
///     red     unobserved, only predicted;
///     violet  known, but without a good view within the limits.
geometry::AttributedCloud coverage_map(std::span<const survey::surfel::EstimatedPatch> patches);

/// Ground-truth surface samples with one mark per sample: covered by the survey, visible from
/// positions that the sensor can reach, and attainable by any view. Marks that were not computed
/// are empty.
struct TrueCoverage {
  geometry::SurfaceSamples samples;
  std::vector<std::uint8_t> is_covered, is_visible, is_attainable;
  double area = 0.0;  ///< of the surface [m^2]
};

/// Writes the samples as PLY with normals, the marks `covered`, `visible` and `attainable`, and
/// colours. Green is covered and violet is not visible. Amber is visible but not attainable, and
/// red is attainable but not covered. Throws Error{bad_file}.
void write_true_coverage(const std::filesystem::path& path, const TrueCoverage& truth);

/// Returns the reason for a colour of a coverage map, or an empty value for other colours.
std::optional<survey::surfel::MissingReason> find_reason(const std::array<std::uint8_t, 3>& colour);

}  // namespace skycap::missions::package
