#include "missions/cli/write_page.h"

#include "missions/report/result_pages.h"

namespace skycap::missions::cli {

void write_page(const std::string& results, bool is_selected, geometry::OutputFolder& folder,
                const Console& console) {
  const bool is_made = is_selected && !console.stop.stop_requested();
  const auto error_message = report::stage_page(results, is_made, folder);
  if (error_message) warn(console, "no report: " + *error_message);
  if (is_selected && !is_made)
    warn(console, "no report written after Ctrl-C; run skycap report to write it");
}

}  // namespace skycap::missions::cli
