#include "missions/cli/write_page.h"

#include "missions/report/result_pages.h"

namespace skycap::missions::cli {

void write_page(const std::string& results, bool is_wanted, geometry::OutputFolder& folder,
                const Console& console) {
  const bool is_made = is_wanted && !console.stop.stop_requested();
  const auto complaint = report::stage_page(results, is_made, folder);
  if (complaint) warn(console, "no report: " + *complaint);
  if (is_wanted && !is_made) warn(console, "no report after Ctrl-C; skycap report writes it");
}

}  // namespace skycap::missions::cli
