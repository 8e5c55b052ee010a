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

std::vector<SurveyedTarget> surveyed(const batch::Prepared& prepared, const Collected& all) {
  std::vector<SurveyedTarget> targets;
  for (const batch::PreparedTarget& target : prepared.targets) {
    const auto item = std::ranges::find(all.items, target.title, &CollectedItem::title);
    SurveyedTarget& one = targets.emplace_back(SurveyedTarget{target, {}, target.refusal});
    if (item != all.items.end() && item->record) {
      one.figures = batch::figures_of(item->folder, *item->record);
    } else if (one.why_none.empty()) {
      one.why_none = not_complete;
    }
  }
  return targets;
}

int district_verb(const ItemOptions& options, const Console& console) {
  const LastResort last_resort(console);
  const batch::DistrictFile district = batch::read_district(options.file);
  const std::filesystem::path out = options.folder(district.name);
  const batch::Prepared prepared = [&] {
    ProgressLine progress(console, options.is_quiet);
    return batch::prepare(district, out, progress.teller());
  }();
  ItemRun run(options, "district", batch::campaign_of(district, prepared, out), out, console);
  // Plans the joint flight of completed surveys and writes the results and the HTML report.
  return run.run([&](const Collected& all, geometry::OutputFolder& folder) {
    const std::vector<SurveyedTarget> targets = surveyed(prepared, all);
    const batch::DistrictFlight flight = batch::plan_district(
        district, prepared, targets, out, [&](const std::string& what) { run.runner().say(what); },
        console.stop);
    run.runner().clear();
    if (console.stop.stop_requested()) return interrupted_exit_code(console);
    folder.write(batch::table_name, batch::targets_csv(targets, flight));
    folder.write(batch::results_name,
                 batch::results_json(district, prepared, targets, flight, out));
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
  CLI::App* verb = app.add_subcommand(
      "district", "Survey several buildings of a map and plan one flight for all");
  const auto options = std::make_shared<ItemOptions>();
  add_item_options(*verb, *options, "District file (docs/reference/batch-files.md)");
  run(*verb, options, district_verb, console, action);
}

}  // namespace skycap::missions::cli
