/// The map that a customer asks for before leaving the site: what is covered, what is missing, why.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "geometry/io/cloud_io.h"
#include "survey/skycap/skycap_planner.h"

namespace skycap::missions::package {

/// A point with normal and colour for each piece of surface that the planner knows or guesses, or
/// that the simulator knows:
///   green   covered, the darker the surer
///   amber   seen, but too thinly for the noise
///   red     never seen; only guessed to be there
///   violet  known, but no place that the limits allow sees it well
geometry::AttributedCloud coverage_map(std::span<const survey::skycap::BelievedPatch> patches);

/// What a colour of such a map says; nothing of colours that no map has.
std::optional<survey::skycap::MissingReason> reason_of(const std::array<std::uint8_t, 3>& colour);

}  // namespace skycap::missions::package
