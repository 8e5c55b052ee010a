#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"
#include "missions/report/result_pages.h"
#include "missions/verbs/verbs.h"

namespace skycap::missions::verbs {

int report_results(const ReportOptions& options, const Console& console) {
  geometry::finish_commit(options.folder);
  const std::vector<report::ResultPage> pages = report::pages_of(options.folder);
  if (options.out && pages.size() > 1) {
    throw Error(ErrorKind::bad_usage, options.folder.string() +
                                          ": has several pages; leave out --out, or move the "
                                          "results of one of them to a folder of their own");
  }
  const std::size_t points = options.points > 0 ? options.points : report::default_report_points;
  for (const report::ResultPage& page : pages) {
    ProgressLine progress(console, false);
    progress.show("reading " + options.folder.string());
    const std::string text = page.make(report::results_in(options.folder), points);
    const std::filesystem::path out = options.out.value_or(options.folder / page.name);
    geometry::write_file(out, text);
    progress.clear();
    console.out << "report: " << out.string() << "\n";
  }
  return 0;
}

}  // namespace skycap::missions::verbs
