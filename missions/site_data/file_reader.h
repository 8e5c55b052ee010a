/// Any file of prior data, by its content and then by its ending.
#pragma once

#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

/// What the file holds, in its own coordinates; clouds are thinned to the source's spacing. Throws
/// Error{bad_file} if it is broken, too large or of no known format.
FileContents read_contents(const Source& source, const SiteFrame& site);

}  // namespace skycap::missions::site_data
