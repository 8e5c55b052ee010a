/// Text descriptions of prior data.
#pragma once

#include <string>

#include "missions/site_data/site_priors.h"

namespace skycap::missions::site_data {

/// Returns the name as in mission files.
const char* name_of(Role role);
const char* name_of(HeightDatum datum);

/// Returns several lines per source: contents, extent and notes of the reader. Returns an empty
/// string without sources.
std::string text_of(const SitePriors& site);

}  // namespace skycap::missions::site_data
