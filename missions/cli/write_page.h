/// The page that a verb leaves beside its other results.
#pragma once

#include <string>

#include "geometry/io/output_folder.h"
#include "missions/cli/console.h"

namespace skycap::missions::cli {

/// Stages the page of staged results, if it is wanted and nobody waits for the program to end:
/// `skycap report` makes it later. Warns if it cannot be made.
void write_page(const std::string& results, bool is_wanted, geometry::OutputFolder& folder,
                const Console& console);

}  // namespace skycap::missions::cli
