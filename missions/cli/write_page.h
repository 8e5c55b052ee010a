/// HTML reports of commands.
#pragma once

#include <string>

#include "geometry/io/output_folder.h"
#include "missions/cli/console.h"

namespace skycap::missions::cli {

/// Stages the HTML report of staged results if `is_selected`. After a stop request the report is
/// skipped with a warning; `skycap report` creates it later. Also warns if the report cannot be
/// created.
void write_page(const std::string& results, bool is_selected, geometry::OutputFolder& folder,
                const Console& console);

}  // namespace skycap::missions::cli
