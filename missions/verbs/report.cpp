#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"
#include "missions/package/package.h"
#include "missions/report/survey_report.h"
#include "missions/verbs/verbs.h"

namespace skycap::missions::verbs {

int report_results(const ReportOptions& options, const Console& console) {
  geometry::finish_commit(options.folder);
  ProgressLine progress(console, false);
  progress.show("reading " + options.folder.string());
  const std::string page =
      report::survey_report(report::results_in(options.folder),
                            options.points > 0 ? options.points : report::default_report_points);
  const std::filesystem::path out = options.out.value_or(options.folder / package::report_name);
  geometry::write_file(out, page);
  progress.clear();
  console.out << "report: " << out.string() << "\n";
  return 0;
}

}  // namespace skycap::missions::verbs
