#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "missions/batch/district/district_results.h"
#include "missions/cli/survey_batch.h"
#include "missions/cli/write_page.h"

namespace skycap::missions::cli {
namespace {

using batch::SurveyedTarget;

constexpr const char* not_complete = "the survey is not complete; see the warnings of its run";

std::vector<SurveyedTarget> surveyed(const batch::DistrictPlan& district_plan,
                                     const Collected& all) {
  std::vector<SurveyedTarget> targets;
  for (const batch::DistrictTarget& target : district_plan.targets) {
    const auto item = std::ranges::find(all.items, target.title, &CollectedItem::title);
    SurveyedTarget& one = targets.emplace_back(SurveyedTarget{target, {}, target.rejection_reason});
    if (item != all.items.end() && item->record) {
      one.figures = batch::compute_figures(item->folder, *item->record);
    } else if (one.failure_reason.empty()) {
      one.failure_reason = not_complete;
    }
  }
  return targets;
}

int run_district_command(const BatchOptions& options, const Console& console) {
  const SignalWatchdog watchdog(console);
  const batch::DistrictFile district = batch::read_district(options.file);
  const std::filesystem::path out = options.folder(district.name);
  const batch::DistrictPlan district_plan = [&] {
    ProgressLine progress(console, options.is_quiet);
    return batch::prepare(district, out, progress.progress_callback());
  }();
  BatchRun run(options, "district", batch::make_campaign(district, district_plan, out), out,
               console);
  // Plans the joint flight of completed surveys and writes the results and the HTML report.
  return run.run([&](const Collected& all, geometry::OutputFolder& folder) {
    const std::vector<SurveyedTarget> targets = surveyed(district_plan, all);
    const batch::DistrictFlight flight = batch::plan_district(
        district, district_plan, targets, out,
        [&](const std::string& what) { run.runner().show_status(what); }, console.stop);
    run.runner().clear();
    if (console.stop.stop_requested()) return interrupted_exit_code(console);
    folder.write(batch::table_name, batch::targets_csv(targets, flight));
    folder.write(batch::results_name,
                 batch::results_json(district, district_plan, targets, flight, out));
    write_page(batch::results_name, options.has_report, folder, console);
    folder.commit();
    const bool is_complete =
        std::ranges::all_of(targets, [](const auto& target) { return target.figures.has_value(); });
    if (!options.is_quiet) {
      console.out << fmt::format("{}: {}\n", district.name,
                                 is_complete ? "complete" : "not complete")
                  << batch::results_text(targets, flight) << "  results   " << out.string() << "\n"
                  << std::flush;
    }
    return is_complete ? 0 : 1;
  });
}

}  // namespace

void add_district(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand(
      "district", "Survey several buildings of a map and plan one flight for all of them");
  const auto options = std::make_shared<BatchOptions>();
  add_batch_options(*command, *options, "District file (docs/reference/batch-files.md)");
  run(*command, options, run_district_command, console, action);
}

}  // namespace skycap::missions::cli
