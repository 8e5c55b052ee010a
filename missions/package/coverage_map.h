/// The map that a customer asks for before leaving the site: what is covered, what is missing, why.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "geometry/io/cloud_io.h"
#include "geometry/surfaces/mesh.h"
#include "survey/skycap/skycap_planner.h"

namespace skycap::missions::package {

/// A point with normal and colour for each piece of surface that the planner knows or guesses, or
/// that the simulator knows:
///   green   covered, the darker the surer
///   amber   seen, but too thinly for the noise
///   red     never seen; only guessed to be there
///   violet  known, but no place that the limits allow sees it well
geometry::AttributedCloud coverage_map(std::span<const survey::skycap::BelievedPatch> patches);

/// The surface's samples as the simulator knows them, a mark for each: what the survey covered,
/// what could be seen from places that the sensor can get to, and what could be covered at all.
/// Marks that nobody has asked for are empty.
struct TrueCoverage {
  geometry::SurfaceSamples samples;
  std::vector<std::uint8_t> is_covered, is_visible, is_attainable;
};

/// Writes them as PLY with normals, the marks as `covered`, `visible` and `attainable`, and
/// colours: green is covered, red could have been, amber was attained by no view that tried, violet
/// cannot be seen. Throws Error{bad_file}.
void write_true_coverage(const std::filesystem::path& path, const TrueCoverage& truth);

/// What a colour of such a map says; nothing of colours that no map has.
std::optional<survey::skycap::MissingReason> reason_of(const std::array<std::uint8_t, 3>& colour);

}  // namespace skycap::missions::package
