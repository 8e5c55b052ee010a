/// Prior data in words.
#pragma once

#include <string>

#include "missions/site_data/site_priors.h"

namespace skycap::missions::site_data {

/// As mission files say it.
const char* name_of(Role role);
const char* name_of(HeightDatum datum);

/// Some lines for each source: what it holds, where that is, what its reader noted. Empty without
/// any.
std::string text_of(const SitePriors& site);

}  // namespace skycap::missions::site_data
