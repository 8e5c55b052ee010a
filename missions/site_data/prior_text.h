/// Text descriptions of prior data.
#pragma once

#include <string>

#include "missions/site_data/site_priors.h"

namespace skycap::missions::site_data {

/// Returns the name as in mission files.
const char* to_string(Role role);
const char* to_string(HeightDatum datum);

/// Returns several lines per source: contents, extent and notes of the reader. Returns an empty
/// string without sources.
std::string format_priors(const SitePriors& site);

}  // namespace skycap::missions::site_data
