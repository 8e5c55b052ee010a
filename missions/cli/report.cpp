#include "geometry/io/file.h"
#include "missions/cli/commands.h"
#include "missions/report/result_pages.h"

namespace skycap::missions::cli {

int report_results(const ReportOptions& options, const Console& console) {
  ProgressLine progress(console, false);
  progress.show("reading " + options.folder.string());
  const std::size_t points = options.points > 0 ? options.points : report::default_report_points;
  for (const report::MadePage& page : report::made_pages(options.folder, points, options.out)) {
    if (page.text) geometry::write_file(page.file, *page.text);
    progress.clear();
    console.out << "report: " << page.file.string() << "\n";
  }
  return 0;
}

}  // namespace skycap::missions::cli
